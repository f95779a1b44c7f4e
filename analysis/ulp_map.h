// SPDX-License-Identifier: Apache-2.0
// Ulp maps: the verdicts around a pair when two of its coordinates move by single ulps, in the manner of the pictures
// in Kettner, Mehlhorn, Pion, Schirra and Yap 2008, "Classroom examples of robustness problems in geometric
// computations".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/pair.h"

namespace graze::analysis {

inline constexpr int kMapSize = 256;             // cells on each side
inline constexpr int kMapCentre = kMapSize / 2;  // column and row of the pair itself
inline constexpr int kMapSample = 1024;          // the oracle confirms one cell in so many, and the pair itself

// Two coordinates of a pair, as places in coordinates(pair).
struct MovedCoordinates {
  int x, y;
  bool operator==(const MovedCoordinates&) const = default;
};

// "b[0].x", of all 18.
std::string name_of_coordinate(int coordinate);
std::optional<int> coordinate_of_name(std::string_view name);

// What a lane says in a cell, or of the truth the first two and not_finite; behind that what foreign code alone does.
enum class Cell : std::uint8_t {
  disjoint,
  intersects,
  false_positive,
  false_negative,
  declined,
  not_finite,
  crashed,
  timed_out,
  unstable
};
inline constexpr int kCellKinds = 9;

struct UlpPanel {
  const Lane* lane;         // null for the truth
  std::vector<Cell> cells;  // kMapSize * kMapSize, row by row

  std::string name() const { return lane ? lane->id : "truth"; }
  std::array<int, kCellKinds> counts() const;
};

struct UlpMap {
  Pair pair;
  MovedCoordinates moved;
  std::vector<UlpPanel> panels;  // the truth, then the lanes
};

// The pair of a cell: x goes up by an ulp from column to column, y goes down by one from row to row, through zero and
// the subnormals. At the ends of float32 it is not finite.
Pair pair_at(const Pair& pair, MovedCoordinates moved, int column, int row);

// The two coordinates of one vertex along which verdicts change most: of a few cells, close ones and far ones, those
// are counted that differ from the one before, in the truth and in each lane; the fewer of both directions decides,
// then the sum, then the order of the coordinates. Around zero an ulp is 2^-149, which says little: a zero moves only
// where nothing changes in both directions without one.
// Requires: finite coordinates; lanes that run here, or have a twin.
MovedCoordinates liveliest_coordinates(const Pair& pair, std::span<const Lane* const> lanes);

// CUDA lanes by their twins; exact lanes are left out, for the truth is theirs, and foreign code that takes all of its
// time on three pairs, or crashes on 3000. Deterministic.
// Requires: finite coordinates; lanes that run here, or have a twin; two coordinates.   Exact: the truth.
// Throws: OracleMismatch where the oracle does not confirm the truth.
UlpMap ulp_map(const Pair& pair, std::span<const Lane* const> lanes, MovedCoordinates moved);

}  // namespace graze::analysis
