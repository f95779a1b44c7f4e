// SPDX-License-Identifier: Apache-2.0
// Compares one map with the known answer, and maps of all kinds of pairs with separate decisions of each cell's pair.
#include "analysis/ulp_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analysis/foreign_testing.h"
#include "analysis/lane_trace.h"
#include "cuda/twin/twin.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

std::vector<const Lane*> lanes_of(std::string_view algorithm) {
  std::vector<const Lane*> result;
  for (const Lane& lane : published_lanes()) {
    const bool here = lane.is_cuda() ? cuda::twin_row(lane).decide != nullptr : runs_on_this_cpu(lane);
    if (here && lane.info->id == algorithm) result.push_back(&lane);
  }
  return result;
}

Cell cell_at(const UlpPanel& panel, int column, int row) {
  return panel.cells[static_cast<std::size_t>(row * kMapSize + column)];
}

// The vertex b[0] lies on a's plane, at the middle of a's edge x = y.
const Pair kOnTheDiagonal{{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}}, {{0.75f, 0.75f, 0}, {0.75f, 0.75f, 1}, {0.5f, 0.75f, 1}}};

TEST(UlpMap, OfAVertexOnAnEdgeIsCutAlongTheDiagonal) {
  const std::vector<const Lane*> lanes = lanes_of("guigue_devillers_2003");
  const UlpMap map = ulp_map(kOnTheDiagonal, lanes, {9, 10});
  ASSERT_EQ(map.panels.size(), lanes.size() + 1);
  EXPECT_EQ(map.panels[0].name(), "truth");
  for (int row = 0; row < kMapSize; ++row) {
    for (int column = 0; column < kMapSize; ++column) {
      const Cell expected = column + row >= kMapSize ? Cell::intersects : Cell::disjoint;  // x >= y
      ASSERT_EQ(cell_at(map.panels[0], column, row), expected) << column << ' ' << row;
    }
  }
  const int below = kMapSize * (kMapSize - 1) / 2;
  EXPECT_EQ(map.panels[0].counts(), (std::array<int, kCellKinds>{kMapSize * kMapSize - below, below}));
}

TEST(UlpMap, StepsAreNeighboursThroughZeroAndToTheEnds) {
  Pair pair = kOnTheDiagonal;
  pair.b[0] = {0.75f, -0.0f, std::numeric_limits<float>::max()};
  const auto x = [&](int column) { return pair_at(pair, {9, 10}, column, kMapCentre).b[0].x; };
  for (int column = 0; column + 1 < kMapSize; ++column) EXPECT_EQ(std::nextafter(x(column), 1.0f), x(column + 1));
  EXPECT_EQ(x(kMapCentre), 0.75f);
  const auto y = [&](int row) { return pair_at(pair, {9, 10}, kMapCentre, row).b[0].y; };
  EXPECT_EQ(y(kMapCentre - 1), 0x1p-149f);
  EXPECT_EQ(y(kMapCentre + 1), -0x1p-149f);
  EXPECT_TRUE(std::signbit(y(kMapCentre)));  // the pair itself, to the bit
  EXPECT_TRUE(is_finite(pair_at(pair, {9, 11}, 0, kMapCentre)));
  EXPECT_FALSE(is_finite(pair_at(pair, {9, 11}, 0, kMapCentre - 1)));
  const UlpMap map = ulp_map(pair, lanes_of("moller_1997"), {9, 11});
  for (const UlpPanel& panel : map.panels) EXPECT_EQ(panel.counts()[5], kMapSize * kMapCentre) << panel.name();
}

TEST(UlpMap, EachCellIsWhatItsPairGets) {
  int wrong = 0;
  for (const strata::StratumInfo& stratum : strata::kStrata) {
    const Pair pair = strata::generate(11, stratum.stratum, 5);
    const std::vector<const Lane*> lanes =
        lanes_of(stratum.stratum < strata::Stratum::sliver ? "interval_overlap" : "moller_1997");
    const MovedCoordinates moved = liveliest_coordinates(pair, lanes);
    EXPECT_EQ(moved.x / 3, moved.y / 3);
    EXPECT_LT(moved.x, moved.y);
    const UlpMap map = ulp_map(pair, lanes, moved);
    for (int cell = 0; cell < kMapSize * kMapSize; cell += 191) {
      const int column = cell % kMapSize, row = cell / kMapSize;
      const Pair own = pair_at(pair, moved, column, row);
      const Verdict truth = oracle::cgal_verdict(own);
      ASSERT_EQ(cell_at(map.panels[0], column, row), truth == Verdict::intersects ? Cell::intersects : Cell::disjoint);
      for (std::size_t l = 0; l < lanes.size(); ++l) {
        const Verdict verdict = decide_lane(*lanes[l], own);
        const Cell expected = verdict == Verdict::declined     ? Cell::declined
                              : verdict == truth               ? cell_at(map.panels[0], column, row)
                              : verdict == Verdict::intersects ? Cell::false_positive
                                                               : Cell::false_negative;
        ASSERT_EQ(cell_at(map.panels[l + 1], column, row), expected) << stratum.id << ' ' << lanes[l]->id;
        wrong += expected == Cell::false_positive || expected == Cell::false_negative;
      }
    }
  }
  EXPECT_GT(wrong, 1000);
}

// This code fails on two columns and two cells.
Verdict fails_in_places(const Pair& pair) {
  const auto at = [&](int column) { return pair.b[0].x == pair_at(kOnTheDiagonal, {9, 10}, column, 0).b[0].x; };
  const float highest = pair_at(kOnTheDiagonal, {9, 10}, 0, 0).b[0].y;
  return at(10)                                         ? Verdict::crashed
         : at(12)                                       ? Verdict::unstable
         : (at(14) || at(16)) && pair.b[0].y == highest ? Verdict::timed_out
                                                        : Verdict::disjoint;
}

TEST(UlpMap, FailuresOfForeignCodeHaveCellsOfTheirOwn) {
  Stranger code(fails_in_places);
  const AlgorithmInfo info{"fails", "test", "", "", "", false};
  const Lane lane{"fails/f32/cpu", &info, Scalar::f32, Variant::cpu, "", {}, -1, code, false, false, true, 0, ""};
  const Lane* const lanes[] = {&lane};
  const UlpMap map = ulp_map(kOnTheDiagonal, lanes, {9, 10});
  ASSERT_EQ(map.panels.size(), 2u);
  for (int row = 0; row < kMapSize; ++row) {
    EXPECT_EQ(cell_at(map.panels[1], 10, row), Cell::crashed);
    EXPECT_EQ(cell_at(map.panels[1], 12, row), Cell::unstable);
  }
  EXPECT_EQ(cell_at(map.panels[1], 14, 0), Cell::timed_out);
  const auto counts = map.panels[1].counts();
  EXPECT_EQ(counts[static_cast<std::size_t>(Cell::timed_out)], 2);
  EXPECT_EQ(counts[static_cast<std::size_t>(Cell::declined)], 0);
  EXPECT_EQ(counts[static_cast<std::size_t>(Cell::crashed)], kMapSize);
}

TEST(UlpMap, CoordinatesAreTheFirstThatChangeVerdictsMost) {
  Pair pair = kOnTheDiagonal;
  EXPECT_EQ(liveliest_coordinates(pair, {}), (MovedCoordinates{3, 4}));  // the far end of a's edge x = y
  std::swap(pair.a[1], pair.a[2]);
  EXPECT_EQ(liveliest_coordinates(pair, {}), (MovedCoordinates{6, 7}));
  pair = kOnTheDiagonal;
  std::swap(pair.a, pair.b);
  EXPECT_EQ(liveliest_coordinates(pair, {}), (MovedCoordinates{0, 1}));
  // Two vertices meet at the origin, and moving another vertex cannot change that.
  pair = {{{0.5f, 0.5f, 1}, {0, 0, 0}, {-0.5f, 0.5f, 1}}, {{1, 0, 0}, {1, -1, 0}, {0, 0, 0}}};
  EXPECT_EQ(liveliest_coordinates(pair, {}).x / 3, 1);
}

TEST(UlpMap, NamesCoordinatesAsTheyAreWritten) {
  EXPECT_EQ(name_of_coordinate(0), "a[0].x");
  EXPECT_EQ(name_of_coordinate(17), "b[2].z");
  for (int c = 0; c < kCoordinates; ++c) EXPECT_EQ(coordinate_of_name(name_of_coordinate(c)), c);
  EXPECT_FALSE(coordinate_of_name("c[0].x"));
}

}  // namespace
}  // namespace graze::analysis
