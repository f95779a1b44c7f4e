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

}  // namespace

void decide(const DecideBlock& block, std::span<const Pair> pairs, VerdictBits& to) { decide_all(block, pairs, to); }
void decide(const DecideBlock& block, std::span<const DoublePair> pairs, VerdictBits& to) {
  decide_all(block, pairs, to);
}

namespace {

std::vector<Verdict> list_of(const LaneVerdicts& said, std::size_t pairs) {
  std::vector<Verdict> verdicts;
  verdicts.reserve(pairs);
  for (std::size_t i = 0; i < pairs; ++i) verdicts.push_back(said.at(i));
  return verdicts;
}

}  // namespace

std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs) {
  VerdictBits bits;
  decide(block, pairs, bits);
  return list_of({bits.intersects, bits.declined, &block, pairs.data()}, pairs.size());
}

std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const DoublePair> pairs) {
  VerdictBits bits;
  decide(block, pairs, bits);
  return list_of({bits.intersects, bits.declined, &block, nullptr, pairs.data()}, pairs.size());
}

std::optional<Verdict> verdict_named(std::string_view word) {
  for (const Verdict verdict : {Verdict::disjoint, Verdict::intersects, Verdict::declined, Verdict::crashed,
                                Verdict::timed_out, Verdict::unstable}) {
    if (word == name(verdict)) return verdict;
  }
  return std::nullopt;
}

}  // namespace graze
