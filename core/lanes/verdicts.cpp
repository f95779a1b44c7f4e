// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/verdicts.h"

namespace graze {
namespace {

template <class AnyPair>
void decide_all(const DecideBlock& block, std::span<const AnyPair> pairs, VerdictBits& to) {
  to.intersects.resize((pairs.size() + 63) / 64);
  to.declined.resize(to.intersects.size());
  if (!pairs.empty()) block(pairs.data(), pairs.size(), to.intersects.data(), to.declined.data());
}

template <class AnyPair>
std::vector<Verdict> all_verdicts(const DecideBlock& block, std::span<const AnyPair> pairs) {
  VerdictBits bits;
  decide_all(block, pairs, bits);
  std::vector<Verdict> verdicts;
  verdicts.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    verdicts.push_back(block.verdict_of(test_bit(bits.intersects, i), test_bit(bits.declined, i), pairs[i]));
  return verdicts;
}

}  // namespace

void decide(const DecideBlock& block, std::span<const Pair> pairs, VerdictBits& to) { decide_all(block, pairs, to); }
void decide(const DecideBlock& block, std::span<const DoublePair> pairs, VerdictBits& to) {
  decide_all(block, pairs, to);
}

std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs) {
  return all_verdicts(block, pairs);
}
std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const DoublePair> pairs) {
  return all_verdicts(block, pairs);
}

std::optional<Verdict> verdict_named(std::string_view word) {
  for (const Verdict verdict : {Verdict::disjoint, Verdict::intersects, Verdict::declined, Verdict::crashed,
                                Verdict::timed_out, Verdict::unstable}) {
    if (word == name(verdict)) return verdict;
  }
  return std::nullopt;
}

}  // namespace graze
