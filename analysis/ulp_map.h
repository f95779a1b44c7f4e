// SPDX-License-Identifier: Apache-2.0
// Ulp maps: the verdicts around a pair as two of its coordinates move by single ulps. The maps follow the pictures in
// Kettner, Mehlhorn, Pion, Schirra and Yap 2008, "Classroom examples of robustness problems in geometric computations".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"

namespace graze::analysis {

inline constexpr int kMapSize = 256;             // cells on each side
inline constexpr int kMapCentre = kMapSize / 2;  // column and row of the pair itself
inline constexpr int kMapSample = 1024;          // the oracle confirms one cell in 1024, and the pair itself

// Two coordinates of a pair, as indices into coordinates(pair).
struct MovedCoordinates {
  int x, y;
  bool operator==(const MovedCoordinates&) const = default;
};

// Names one of the 18 coordinates, such as "b[0].x".
std::string name_of_coordinate(int coordinate);
std::optional<int> coordinate_of_name(std::string_view name);

// A lane's result in a cell. The truth has only disjoint, intersects and not_finite; only foreign code has crashed,
// timed_out and unstable.
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
  AnyPair pair;
  MovedCoordinates moved;
  std::vector<UlpPanel> panels;  // the truth, then the lanes
};

// Returns the pair of a cell. x rises by one ulp per column, and y falls by one ulp per row, through zero and the
// subnormals. At the limits of the coordinate type the pair is not finite.
template <class Real>
BasicPair<Real> pair_at(const BasicPair<Real>& pair, MovedCoordinates moved, int column, int row);

// Chooses the two coordinates of one vertex along which verdicts change most. Samples cells near and far, and counts
// those that differ from the previous cell, in the truth and in each lane. Compares the smaller count of the two
// directions first, then the sum, then the order of the coordinates. Around zero, an ulp is the smallest positive
// number of the coordinate type, and moving by it shows little. So a zero moves only if no other choice changes
// verdicts in both directions. Requires: finite coordinates; lanes that run here or have a twin.
MovedCoordinates liveliest_coordinates(const AnyPair& pair, std::span<const Lane* const> lanes);

// CUDA lanes run as twins. Exact lanes are left out, because their verdict is the truth. Foreign code is left out if it
// times out on three pairs or crashes on 3000. Deterministic.
// Requires: finite coordinates; lanes that run here or have a twin; two coordinates.   Exact: the truth.
// Throws: OracleMismatch if the oracle does not confirm the truth.
UlpMap ulp_map(const AnyPair& pair, std::span<const Lane* const> lanes, MovedCoordinates moved);

}  // namespace graze::analysis
