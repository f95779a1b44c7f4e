// SPDX-License-Identifier: Apache-2.0
// Neighbours of a pair: images that must have the same verdict, and copies with one coordinate moved a little.
#pragma once

#include <vector>

#include "core/pair.h"

namespace graze::analysis {

// All images are exact in the coordinate type, so their truth is the pair's own (except for `parts`). The first one is
// the pair itself.
// The 72 orders of the two triangles and of the vertices within each.
template <class Real>
std::vector<BasicPair<Real>> orders(const BasicPair<Real>& pair);
// The 8 mirror images: every combination of negated axes.
template <class Real>
std::vector<BasicPair<Real>> mirrored(const BasicPair<Real>& pair);
// Scales the pair by 2^k, for each k from -kMostScaling to kMostScaling at which no coordinate overflows or loses bits.
inline constexpr int kMostScaling = 64;
template <class Real>
std::vector<BasicPair<Real>> scalings(const BasicPair<Real>& pair);
template <class Real>
std::vector<BasicPair<Real>> axes(const BasicPair<Real>& pair);  // the 6 orders of the axes
// Translations that move a vertex to the origin, and the translations by ±(2^k, 2^k, 2^k), where 2^k is the largest
// coordinate rounded down to a power of two. Translations that would round a coordinate are left out.
template <class Real>
std::vector<BasicPair<Real>> translated(const BasicPair<Real>& pair);

// Replaces one triangle by one of the four parts into which its edge midpoints divide it, if the midpoints are exact in
// the coordinate type. If a part intersects, the pair intersects.
template <class Real>
std::vector<BasicPair<Real>> parts(const BasicPair<Real>& pair);

// Moves one coordinate by an ulp and by 2^-10 of its size, up and down. A zero moves as far as the largest coordinate
// would. Returns the finite results: four, except near the limits of the type.
template <class Real>
std::vector<BasicPair<Real>> nudged(const BasicPair<Real>& pair, int coordinate);

}  // namespace graze::analysis
