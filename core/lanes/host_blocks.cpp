// SPDX-License-Identifier: Apache-2.0
// The block functions of the host lanes, compiled once per variant, each in its own namespace GRAZE_FP and with its own
// contraction flags. Define nothing else here, or the linker would mix the variants.
#include "core/lanes/host_blocks.h"
#include "core/algorithms/algorithms.h"
#include "core/decide_each.h"
#include "core/lanes/decide_under.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Algorithm, class Real, class AnyPair>
void decide_block(const AnyPair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_each(pairs, count, intersects, declined,
              [](const AnyPair& pair) { return decide_widened<Algorithm, Real>(pair); });
}

template <class Algorithm, class Real, class Number, class AnyPair>
void decide_within_block(const Epsilons& epsilons, const AnyPair* pairs, std::size_t count, std::uint64_t* intersects,
                         std::uint64_t* declined) {
  const Tolerances<Real> tolerances(epsilons);
  decide_each(pairs, count, intersects, declined, [&](const AnyPair& pair) {
    return decide_widened<Real>(
        pair, [&](const auto& a, const auto& b) { return decide_within<Algorithm, Number>(a, b, tolerances); });
  });
}

template <class Algorithm, class Real, class AnyPair>
void decide_bounded_block(const AnyPair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_each(pairs, count, intersects, declined, [](const AnyPair& pair) {
    return decide_widened<Real>(pair, [](const auto& a, const auto& b) { return decide_bounded<Algorithm>(a, b); });
  });
}

template <class... Algorithm>
constexpr HostBlocks blocks(const std::tuple<Algorithm...>*) {
  return {std::array<DecideBlock::Function, 2>{decide_block<Algorithm, float>, decide_block<Algorithm, double>}...};
}

template <class... Algorithm>
[[maybe_unused]] constexpr HostDoubleBlocks double_blocks(const std::tuple<Algorithm...>*) {
  return {decide_block<Algorithm, double, DoublePair>...};
}

template <class Algorithm, class Real, class AnyPair>
constexpr PolicyFunctions<AnyPair> policy_blocks() {
  PolicyFunctions<AnyPair> result{decide_within_block<Algorithm, Real, Real>,
                                  decide_within_block<Algorithm, Real, WithMagnitude<Real>>};
#ifndef __FAST_MATH__  // fast math invalidates the bounds
  if constexpr (Algorithm::kInfo.right_without_rounding) result.bound = decide_bounded_block<Algorithm, Real>;
#endif
  return result;
}

template <class... Algorithm>
constexpr HostPolicyBlocks policies(const std::tuple<Algorithm...>*) {
  return {std::array<PolicyBlocks, 2>{policy_blocks<Algorithm, float, Pair>(),
                                      policy_blocks<Algorithm, double, Pair>()}...};
}

template <class... Algorithm>
[[maybe_unused]] constexpr HostDoublePolicyBlocks double_policies(const std::tuple<Algorithm...>*) {
  return {policy_blocks<Algorithm, double, DoublePair>()...};
}

constexpr const Algorithms* kAll = nullptr;

extern const HostBlocks kHostBlocks = blocks(kAll);
extern const HostPolicyBlocks kHostPolicyBlocks = policies(kAll);
#ifdef __wasm__  // the module takes float32 alone, and every report carries its code
extern const HostDoubleBlocks kHostDoubleBlocks{};
extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks{};
#else
extern const HostDoubleBlocks kHostDoubleBlocks = double_blocks(kAll);
extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks = double_policies(kAll);
#endif

}  // namespace GRAZE_FP
}  // namespace graze
