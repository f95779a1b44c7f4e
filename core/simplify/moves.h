// SPDX-License-Identifier: Apache-2.0
// The minimiser's single moves: the candidates for one step from a pair. A move may lead to any pair; the minimiser
// keeps only results that are simpler and fail in the same way.
#pragma once

#include <cstddef>
#include <vector>

#include "core/pair.h"

namespace graze {

// The moves come in kinds. Each entry below gives a number of kinds and what they do, in order:
//   7   a vertex moved to the origin (none, then each); all coordinates rounded to a lattice of 1 to 24 bits (51 for
//       doubles) or not at all; then scaled to whole numbers, or to a size of about one, or not
//   6   a vertex replaced by another, by one of the 27 points with coordinates in {-1, 0, 1}, or by p + q - r of
//       three vertices
//   3   on one axis: several vertices given one value, 0, 1, -1 or one that occurs there; all translated by one
//       vertex's value; all scaled by a power of two
//   18  a value, wherever it occurs with either sign, replaced
//   18  one coordinate replaced
//   18  two coordinates, each replaced by 0, 1 or -1
//   1   two axes or vertices exchanged, the triangles exchanged, an axis mirrored; a multiple of an axis added to
//       another: once, twice, or so that a vertex's coordinate becomes 0 or the remainder of a division; all scaled
//       by a power of two
//   6   four vertices mapped to the origin and the ends of the unit vectors, rounded to a lattice or not
// A value's replacements are 0, a value that occurs, its half or double, or a whole number up to 9, each with either
// sign; the value rounded towards or away from zero, to fewer bits or to a whole number; and its neighbours.
inline constexpr int kMoveKinds = 77;

// Appends the results of the moves of a kind; only finite pairs, some of which may equal the original pair.
// Requires: finite coordinates, 0 <= kind < kMoveKinds.
template <class Real>
void append_moves(const BasicPair<Real>& pair, int kind, std::vector<BasicPair<Real>>& moved);

// Returns: the results of the moves of this kind that are simpler than the pair, each once, the simplest first. Adds
// the number of all results to `made`.   Requires: as append_moves.
template <class Real>
std::vector<BasicPair<Real>> simpler_moves(const BasicPair<Real>& pair, int kind, std::size_t& made);

}  // namespace graze
