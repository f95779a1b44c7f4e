// SPDX-License-Identifier: Apache-2.0
// The host lanes' block functions, compiled once per variant, in the variant's namespace GRAZE_FP and with its
// contraction flags. Define nothing else here, or the linker would mix the variants.
#include "core/lanes/host_blocks.h"
#include "core/algorithms/algorithms.h"
#include "core/decide_each.h"
#include "core/lanes/decide_under.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Algorithm, class Real>
void decide_block(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_each(pairs, count, intersects, declined,
              [](const Pair& pair) { return decide_widened<Algorithm, Real>(pair); });
}

template <class Algorithm, class Real, class Number>
void decide_within_block(const Epsilons& epsilons, const Pair* pairs, std::size_t count, std::uint64_t* intersects,
                         std::uint64_t* declined) {
  const Tolerances<Real> tolerances(epsilons);
  decide_each(pairs, count, intersects, declined, [&](const Pair& pair) {
    return decide_widened<Real>(
        pair, [&](const auto& a, const auto& b) { return decide_within<Algorithm, Number>(a, b, tolerances); });
  });
}

template <class Algorithm, class Real>
void decide_bounded_block(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_each(pairs, count, intersects, declined, [](const Pair& pair) {
    return decide_widened<Real>(pair, [](const auto& a, const auto& b) { return decide_bounded<Algorithm>(a, b); });
  });
}

template <class... Algorithm>
constexpr HostBlocks blocks(const std::tuple<Algorithm...>*) {
  return {std::array<DecideBlock::Function, 2>{decide_block<Algorithm, float>, decide_block<Algorithm, double>}...};
}

template <class Algorithm, class Real>
constexpr PolicyBlocks policy_blocks() {
  PolicyBlocks result{decide_within_block<Algorithm, Real, Real>,
                      decide_within_block<Algorithm, Real, WithMagnitude<Real>>};
#ifndef __FAST_MATH__  // fast math invalidates the bounds
  if constexpr (Algorithm::kInfo.right_without_rounding) result.bound = decide_bounded_block<Algorithm, Real>;
#endif
  return result;
}

template <class... Algorithm>
constexpr HostPolicyBlocks policies(const std::tuple<Algorithm...>*) {
  return {std::array<PolicyBlocks, 2>{policy_blocks<Algorithm, float>(), policy_blocks<Algorithm, double>()}...};
}

extern const HostBlocks kHostBlocks = blocks(static_cast<const Algorithms*>(nullptr));
extern const HostPolicyBlocks kHostPolicyBlocks = policies(static_cast<const Algorithms*>(nullptr));

}  // namespace GRAZE_FP
}  // namespace graze
