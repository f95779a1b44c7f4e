// SPDX-License-Identifier: Apache-2.0
// A lane under many tolerances at once, for sweeps: a pair is decided again only where some comparison changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/lanes/lanes.h"

namespace graze {

// Decides the pairs under each of the tolerances: bit i % 64 of word i / 64 of each row; the rows, of (count + 63) / 64
// words, stand in the order of the tolerances. Verdicts are those of the lane under each alone.
// Requires: no tolerance is less than the one before; relative ones in all of them, or in none.
using DecideLadder = void (*)(std::span<const Epsilons> rungs, const Pair* pairs, std::size_t count,
                              std::uint64_t* intersects, std::uint64_t* declined);

// Null for lanes of other variants than cpu: a compiler that contracts might do so otherwise here than in the lane.
DecideLadder ladder_of(const Lane& lane, bool relative);

}  // namespace graze
