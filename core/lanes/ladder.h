// SPDX-License-Identifier: Apache-2.0
// Decides with a lane under many tolerances, for sweeps. A pair is decided anew only if a comparison's outcome changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/lanes/lanes.h"

namespace graze {

// Decides the pairs under each tolerance (rung), with the same verdicts as the lane under that tolerance. Each rung has
// a row of (count + 63) / 64 words, in the order of the rungs; pair i is bit i % 64 of word i / 64 of a row.
// Requires: tolerances do not decrease from rung to rung; all rungs have relative tolerances, or none has.
template <class Real>
using DecideLadder = void (*)(std::span<const Epsilons> rungs, const BasicPair<Real>* pairs, std::size_t count,
                              std::uint64_t* intersects, std::uint64_t* declined);

struct Ladders {
  DecideLadder<float> floats = nullptr;
  DecideLadder<double> doubles = nullptr;  // only for lanes in double

  explicit operator bool() const { return floats; }
};

// Returns: none if the variant is not cpu, because a compiler might contract differently here than in the lane.
Ladders ladders_of(const Lane& lane, bool relative);

}  // namespace graze
