// SPDX-License-Identifier: Apache-2.0
// Block functions for pairs of doubles, for the host lanes in double. Compiled once per variant like host_blocks.cpp.
// These functions have a separate file because fast-math results depend on what else the compiler sees: in one file
// with them, lanes on float32 pairs would give other verdicts. Define nothing else here.
#include "core/algorithms/algorithms.h"
#include "core/decide_each.h"
#include "core/lanes/decide_under.h"
#include "core/lanes/host_blocks.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Algorithm>
void decide_doubles(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_each(pairs, count, intersects, declined,
              [](const DoublePair& pair) { return Algorithm::decide(pair.a, pair.b); });
}

template <class Algorithm, class Number>
void decide_doubles_within(const Epsilons& epsilons, const DoublePair* pairs, std::size_t count,
                           std::uint64_t* intersects, std::uint64_t* declined) {
  const Tolerances<double> tolerances(epsilons);
  decide_each(pairs, count, intersects, declined,
              [&](const DoublePair& pair) { return decide_within<Algorithm, Number>(pair.a, pair.b, tolerances); });
}

template <class Algorithm>
void decide_doubles_bounded(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects,
                            std::uint64_t* declined) {
  decide_each(pairs, count, intersects, declined,
              [](const DoublePair& pair) { return decide_bounded<Algorithm>(pair.a, pair.b); });
}

template <class Algorithm>
constexpr PolicyFunctions<DoublePair> policies_of_doubles() {
  PolicyFunctions<DoublePair> result{decide_doubles_within<Algorithm, double>,
                                     decide_doubles_within<Algorithm, WithMagnitude<double>>};
#ifndef __FAST_MATH__  // fast math invalidates the bounds
  if constexpr (Algorithm::kInfo.right_without_rounding) result.bound = decide_doubles_bounded<Algorithm>;
#endif
  return result;
}

template <class... Algorithm>
constexpr HostDoubleBlocks double_blocks(const std::tuple<Algorithm...>*) {
  return {decide_doubles<Algorithm>...};
}

template <class... Algorithm>
constexpr HostDoublePolicyBlocks double_policies(const std::tuple<Algorithm...>*) {
  return {policies_of_doubles<Algorithm>()...};
}

extern const HostDoubleBlocks kHostDoubleBlocks = double_blocks(static_cast<const Algorithms*>(nullptr));
extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks = double_policies(static_cast<const Algorithms*>(nullptr));

}  // namespace GRAZE_FP
}  // namespace graze
