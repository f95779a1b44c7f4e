// SPDX-License-Identifier: Apache-2.0
// The loop that block functions share: it decides a block's pairs one by one and packs the verdicts into bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/pair.h"
#include "core/verdict.h"

namespace graze {
inline namespace GRAZE_FP {

// Bit i % 64 of word i / 64 is the verdict of decide(pairs[i]). Unused bits become zero.
template <class AnyPair, class Decide>
void decide_each(const AnyPair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined,
                 const Decide& decide) {
  for (std::size_t word = 0; word * 64 < count; ++word) {
    std::uint64_t yes = 0, no_answer = 0;
    for (std::size_t bit = 0; bit < 64 && word * 64 + bit < count; ++bit) {
      const Verdict verdict = decide(pairs[word * 64 + bit]);
      yes |= std::uint64_t{verdict == Verdict::intersects} << bit;
      no_answer |= std::uint64_t{verdict == Verdict::declined} << bit;
    }
    intersects[word] = yes;
    declined[word] = no_answer;
  }
}

}  // namespace GRAZE_FP
}  // namespace graze
