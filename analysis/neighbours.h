// SPDX-License-Identifier: Apache-2.0
// Pairs beside a pair: those that must have the same verdict, and those with one coordinate moved a little.
#pragma once

#include <vector>

#include "core/pair.h"

namespace graze::analysis {

// All exact in float32, so that the truth is the pair's own (but of parts). The pair itself is the first of each.
std::vector<Pair> orders(const Pair& pair);    // the 72: which triangle is first, and the order of each one's vertices
std::vector<Pair> mirrored(const Pair& pair);  // the 8: each axis turned round or not
// Times 2^k, for the k from -kMostScaling to kMostScaling with which no coordinate overflows or loses bits.
inline constexpr int kMostScaling = 64;
std::vector<Pair> scalings(const Pair& pair);
std::vector<Pair> axes(const Pair& pair);  // the 6 orders of the axes
// Moved so that a vertex lies in the origin, and by the power of two of the largest coordinate along (1, 1, 1) and
// back, where no coordinate is rounded by it.
std::vector<Pair> translated(const Pair& pair);

// One triangle replaced by one of the four into which the middles of its edges divide it, where these are exact in
// float32: what intersects a part intersects the pair.
std::vector<Pair> parts(const Pair& pair);

// One coordinate moved by an ulp and by 2^-10 of itself, up and down; a zero by as much as the largest coordinate would
// be. Those that stay finite: four, but near the ends of float32.
std::vector<Pair> nudged(const Pair& pair, int coordinate);

}  // namespace graze::analysis
