// SPDX-License-Identifier: Apache-2.0
// The block functions of the host lanes. Compiled once per variant, each in its own namespace GRAZE_FP and with its
// own contraction flags; nothing else may be defined here, or the linker would mix the variants.
#include "core/host_blocks.h"
#include "core/algorithms/algorithms.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Algorithm, class Real>
void decide_block(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  for (std::size_t word = 0; word * 64 < count; ++word) {
    std::uint64_t yes = 0, no_answer = 0;
    for (std::size_t bit = 0; bit < 64 && word * 64 + bit < count; ++bit) {
      const Verdict verdict = decide_widened<Algorithm, Real>(pairs[word * 64 + bit]);
      yes |= std::uint64_t{verdict == Verdict::intersects} << bit;
      no_answer |= std::uint64_t{verdict == Verdict::declined} << bit;
    }
    intersects[word] = yes;
    declined[word] = no_answer;
  }
}

template <class... Algorithm>
constexpr HostBlocks blocks(const std::tuple<Algorithm...>*) {
  return {std::array<DecideBlock::Function, 2>{decide_block<Algorithm, float>, decide_block<Algorithm, double>}...};
}

extern const HostBlocks kHostBlocks = blocks(static_cast<const Algorithms*>(nullptr));

}  // namespace GRAZE_FP
}  // namespace graze
