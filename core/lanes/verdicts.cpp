// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/verdicts.h"

namespace graze {

std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs) {
  std::vector<std::uint64_t> intersects((pairs.size() + 63) / 64), declined(intersects.size());
  if (!pairs.empty()) block(pairs.data(), pairs.size(), intersects.data(), declined.data());
  std::vector<Verdict> verdicts;
  verdicts.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    verdicts.push_back(block.verdict_of(intersects[i / 64] >> i % 64 & 1, declined[i / 64] >> i % 64 & 1, pairs[i]));
  return verdicts;
}

std::optional<Verdict> verdict_named(std::string_view word) {
  for (const Verdict verdict : {Verdict::disjoint, Verdict::intersects, Verdict::declined, Verdict::crashed,
                                Verdict::timed_out, Verdict::unstable}) {
    if (word == name(verdict)) return verdict;
  }
  return std::nullopt;
}

}  // namespace graze
