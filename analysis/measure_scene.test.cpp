// SPDX-License-Identifier: Apache-2.0
// Tests scenes measured from real triangles. Pairs drawn in a scene resemble its triangles, grids are found only if
// they exist, and near contacts are near in the scene's own ulps.
#include "analysis/measure_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/message_testing.h"
#include "oracle/truth.h"
#include "strata/scene/envelope.h"

namespace graze::analysis {
namespace {

using strata::GridSpec;
using strata::Stratum;
using Triangle = std::array<Vec3<float>, 3>;

Vec3<double> wide(const Vec3<float>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

// A hilly sheet of n * n squares. Each square is cut into two triangles, and neighbouring triangles share vertices.
std::vector<Triangle> sheet(int n, double step, Vec3<double> place) {
  const auto at = [&](int i, int j) -> Vec3<float> {
    const double x = i * (1 + i * 0.05), y = j * (1 + j * 0.03), z = 1.5 * std::sin(0.7 * i) + std::cos(0.9 * j);
    return {static_cast<float>(place.x + step * x), static_cast<float>(place.y + step * y),
            static_cast<float>(place.z + step * z)};
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return triangles;
}

SceneSample all_pairs_of(const std::vector<Triangle>& triangles) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      pairs.push_back(
          {{triangles[j][0], triangles[j][1], triangles[j][2]}, {triangles[i][0], triangles[i][1], triangles[i][2]}});
  }
  SceneSample sample = sample_of(pairs);
  sample.triangles = triangles;
  return sample;
}

double longest(const Vec3<float> (&v)[3]) {
  double squared = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3<double> e = wide(v[(i + 1) % 3]) - wide(v[i]);
    squared = std::max(squared, dot(e, e));
  }
  return std::sqrt(squared);
}

double aspect(const Vec3<float> (&v)[3]) {
  const Vec3<double> n = cross(wide(v[1]) - wide(v[0]), wide(v[2]) - wide(v[0]));
  return longest(v) * longest(v) / std::sqrt(dot(n, n));
}

TEST(MeasureScene, WhatIsDrawnIsLikeTheMesh) {
  const std::vector<Triangle> mesh = sheet(24, 3.7123456789, {120, -15, 2000});
  const strata::SceneFile file = measure_scene(all_pairs_of(mesh), "sheet");
  EXPECT_EQ(file.edges.size(), 17u);
  EXPECT_FALSE(file.grid);
  std::vector<double> edges, aspects;
  for (const Triangle& t : mesh) {
    const Vec3<float> v[3]{t[0], t[1], t[2]};
    edges.push_back(longest(v));
    aspects.push_back(aspect(v));
    for (const Vec3<float>& corner : t) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto& [low, high] = file.extent[static_cast<std::size_t>(axis)];
        const double x = static_cast<double>(component(corner, axis));
        EXPECT_TRUE(strata::as_float32(low) <= x && x <= strata::as_float32(high)) << x;
      }
    }
  }
  std::vector<double> drawn_edges, drawn_aspects;
  strata::SceneFile roomy = file;  // the sheet is flat, and without room above it, drawn triangles would be flattened
  roomy.extent[2] = {1900, 2100};
  const strata::Scene scene = strata::resolved(strata::parse_scene("s", strata::scene_text(roomy)));
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const Pair pair = strata::generate(1, Stratum::near_vertex_face, scene, i);
    for (const auto* v : {&pair.a, &pair.b}) {
      drawn_edges.push_back(longest(*v));
      drawn_aspects.push_back(aspect(*v));
    }
  }
  for (auto* values : {&edges, &aspects, &drawn_edges, &drawn_aspects}) std::sort(values->begin(), values->end());
  for (std::size_t q = 1; q < 16; ++q) {
    EXPECT_NEAR(drawn_edges[drawn_edges.size() * q / 16] / edges[edges.size() * q / 16], 1, 0.03) << q;
    EXPECT_NEAR(drawn_aspects[drawn_aspects.size() * q / 16] / aspects[aspects.size() * q / 16], 1, 0.03) << q;
  }
}

TEST(MeasureScene, KindsAndMarginsAreThoseOfThePairs) {
  const Vec3<float> o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, xy{1, 1, 0}, z{0.3f, 0.3f, 1}, w{0.3f, 0.3f, 0.25f};
  const Vec3<float> far{9, 9, 9};
  const std::vector<Pair> pairs = {{{o, x, y}, {o, x, y}},                 // the same triangle twice: coplanar
                                   {{o, x, y}, {x, y, xy}},                // shared edge
                                   {{o, x, y}, {o, z, {-1, 0.5f, 0.5f}}},  // shared vertex
                                   {{o, x, y}, {w, z, {0.3f, 0.4f, -1}}},  // general
                                   {{o, x, y}, {{0.1f, 0.1f, 0}, {0.2f, 0.1f, 0}, {0.1f, 0.3f, 0}}},  // coplanar
                                   {{o, x, y}, {w, w, {0.3f, 0.3f, -1}}},                             // degenerate
                                   {{o, x, y}, {far, far, far}}};                                     // boxes apart
  const SceneSample sample = sample_of(pairs);
  EXPECT_EQ(sample.pairs, 6u);
  const strata::SceneFile file = measure_scene(sample, "pairs");
  const auto sixth = [](int n) { return n == 2 ? 0.333333 : 0.166667; };
  EXPECT_EQ(file.mix, (std::array<double, strata::kKinds>{sixth(1), sixth(1), sixth(1), sixth(2), sixth(1)}));
  double all = 0;
  for (const auto& [bucket, share] : file.margins) all += share;
  EXPECT_NEAR(all, 1, 1e-5);
  EXPECT_NEAR(file.margins.at(0), 4.0 / 6, 1e-5);  // the neighbours and the coplanar pairs
}

// A survey in metres, measured to the centimetre, with coordinates at which float32 has steps of half a metre.
TEST(MeasureScene, DoublesAreMeasuredAsTheyAre) {
  const auto at = [](int i, int j) -> Vec3<double> {
    const auto centimetres = [](double x) { return std::round(x * 100) / 100; };
    return {centimetres(500000.25 + 0.37 * i + 0.01 * j), centimetres(5400000.01 + 0.41 * j),
            centimetres(30 + std::sin(0.7 * i) + std::cos(0.9 * j))};
  };
  std::vector<std::array<Vec3<double>, 3>> mesh;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      mesh.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  std::vector<DoublePair> pairs;
  std::vector<Pair> stored;
  std::vector<double> edges;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3<double> e = mesh[i][(k + 1) % 3] - mesh[i][k];
      squared = std::max(squared, dot(e, e));
    }
    edges.push_back(std::sqrt(squared));
    for (std::size_t j = 0; j < i; ++j) {
      pairs.push_back({{mesh[j][0], mesh[j][1], mesh[j][2]}, {mesh[i][0], mesh[i][1], mesh[i][2]}});
      stored.push_back(stored_in_float32(pairs.back()));
    }
  }
  std::sort(edges.begin(), edges.end());
  DoubleSceneSample sample = sample_of(pairs);
  sample.triangles = mesh;
  const strata::SceneFile file = measure_scene(sample, "survey");
  EXPECT_TRUE(file.in_doubles);
  EXPECT_EQ(file.extent[0], (std::array<double, 2>{500000.25, 500003.29}));
  EXPECT_EQ(file.extent[1], (std::array<double, 2>{5400000.01, 5400003.29}));
  EXPECT_EQ(file.grid, (GridSpec{true, 2}));
  EXPECT_NEAR(file.edges.front(), edges.front(), 1e-5);
  EXPECT_NEAR(file.edges.back(), edges.back(), 1e-5);
  EXPECT_EQ(file.mix[static_cast<std::size_t>(strata::Kind::degenerate)], 0);
  EXPECT_EQ(strata::parse_scene("s", strata::scene_text(file)), file);
  // The scene as float32 stores it is another scene.
  const strata::SceneFile other = measure_scene(sample_of(stored), "survey");
  EXPECT_FALSE(other.in_doubles);
  EXPECT_EQ(other.extent[1], (std::array<double, 2>{5400000, 5400003.5}));
  EXPECT_NE(other.edges, file.edges);
}

std::optional<GridSpec> grid_found(double step, bool decimal, int places) {
  std::vector<Triangle> mesh = sheet(12, step, {30, 70, 900});
  for (Triangle& t : mesh) {
    for (Vec3<float>& v : t) {
      for (int axis = 0; axis < 3; ++axis) {
        const double x = static_cast<double>(component(v, axis));
        const double scale = decimal ? std::pow(10, places) : std::ldexp(1, -places);
        component(v, axis) = static_cast<float>(std::round(x * scale) / scale);
      }
    }
  }
  return measure_scene(all_pairs_of(mesh), "sheet").grid;
}

TEST(MeasureScene, GridsAreFoundWhereTheyAre) {
  EXPECT_EQ(grid_found(3.7, true, 2), (GridSpec{true, 2}));
  EXPECT_EQ(grid_found(3.7, true, 1), (GridSpec{true, 1}));
  EXPECT_EQ(grid_found(3.7, false, -6), (GridSpec{false, -6}));
  EXPECT_EQ(grid_found(37, true, 0), (GridSpec{false, 0}));  // whole numbers
  EXPECT_EQ(grid_found(3.7, true, 12), std::nullopt);        // finer than float32's steps
  EXPECT_EQ(measure_scene(all_pairs_of(sheet(12, 3.7, {1e6, 2e6, 3e6})), "sheet").grid, std::nullopt);
  EXPECT_EQ(measure_scene(all_pairs_of(sheet(1, 1.25, {0, 0, 0})), "two").grid,
            std::nullopt);  // too few numbers as evidence
}

TEST(MeasureScene, WhatCannotBeMeasuredIsSaid) {
  const auto error = [](const std::vector<Pair>& pairs) -> std::string {
    try {
      measure_scene(sample_of(pairs), "x.pairs");
    } catch (const std::runtime_error& thrown) {
      return thrown.what();
    }
    return "none";
  };
  EXPECT_TRUE(names(error({}), {"x.pairs", "boxes"}));
  EXPECT_TRUE(names(error({Pair{}}), {"x.pairs", "degenerate"}));
  Pair large{{{0, 0, 0}, {0x1p127f, 0, 0}, {0, 0x1p127f, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  EXPECT_TRUE(names(error({large}), {"x.pairs", "2^126"}));
}

// The share of pairs with a margin below 16 ulps of the largest coordinate.
template <class Draw>
double near_share(const Draw& draw) {
  constexpr int kPairs = 4000;
  int near = 0;
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const auto pair = draw(i);
    near += std::fabs(oracle::truth(pair).margin_ulps) < 16;
  }
  return static_cast<double>(near) / kPairs;
}

TEST(SceneStrata, NearContactsAreNearInTheScenesUlps) {
  for (const char* text :
       {"extent = [[120000, 120800], [-5400, -5000], [300, 900]]\nedges = [0.5, 40]",
        "extent = [[120000, 120800], [-5400, -5000], [300, 900]]\nedges = [0.5, 40]\ngrid = { decimals = 3 }",
        "extent = [-1, 1]\nedges = [0.01, 0.5]", "extent = [-1e30, 1e30]\nedges = [1e28, 3e29]"}) {
    const strata::Scene scene = strata::resolved(strata::parse_scene("s", text));
    for (const Stratum stratum :
         {Stratum::near_vertex_face, Stratum::near_edge_edge, Stratum::near_vertex_edge, Stratum::near_vertex_vertex}) {
      const double without = near_share([&](std::uint64_t i) { return strata::generate(1, stratum, i); });
      const double within = near_share([&](std::uint64_t i) { return strata::generate(1, stratum, scene, i); });
      EXPECT_GT(without, 0.6);
      EXPECT_GT(within, 0.9 * without) << text << ' ' << static_cast<int>(stratum);
      EXPECT_LT(within, 0.999);  // some pairs have larger margins
    }
  }
}

TEST(SceneStrata, NearContactsOfDoublesAreNearInTheScenesUlps) {
  for (const char* text : {"extent = [[500000, 500300], [5400000, 5400300], [0, 60]]\nedges = [0.02, 30]",
                           "extent = [-1, 1]\nedges = [0.01, 0.5]", "extent = [-1e30, 1e30]\nedges = [1e28, 3e29]"}) {
    const strata::Scene scene =
        strata::resolved(strata::parse_scene("s", std::string("coordinates = \"f64\"\n") + text));
    for (const Stratum stratum :
         {Stratum::near_vertex_face, Stratum::near_edge_edge, Stratum::near_vertex_edge, Stratum::near_vertex_vertex}) {
      const double without = near_share([&](std::uint64_t i) { return strata::generate_doubles(1, stratum, i); });
      const double within = near_share([&](std::uint64_t i) { return strata::generate_doubles(1, stratum, scene, i); });
      EXPECT_GT(without, 0.6);
      EXPECT_GT(within, 0.9 * without) << text << ' ' << static_cast<int>(stratum);
      EXPECT_LT(within, 0.999);  // some pairs have larger margins
    }
  }
}

// In scene strata, as in others, the oracle's two decisions agree, and both verdicts occur.
TEST(SceneStrata, BothVerdictsOccurAndTheOraclesDecisionsAgree) {
  const strata::SceneFile file = strata::parse_scene("s",
                                                     "extent = [[1000, 1800], [-540, -500], [3, 900]]\nedges = [0.5, "
                                                     "20]\naspect = [1.2, 3000]\ngrid = { power_of_two = -5 }");
  const strata::Scene scene = strata::resolved(file), of_doubles = strata::resolved(strata::with_type(file, true));
  for (const strata::StratumInfo& row : strata::kStrata) {
    if (strata::left_out(file, row.stratum)) continue;
    int intersecting = 0, of_doubles_intersecting = 0;
    for (std::uint64_t i = 0; i < 10'000; ++i) {
      const Pair pair = strata::generate(2, row.stratum, scene, i);
      const bool intersects = oracle::cgal_verdict(pair) == Verdict::intersects;
      ASSERT_EQ(intersects, oracle::gmp_contact(pair) != Contact::none) << row.id << i;
      intersecting += intersects;
      const DoublePair doubles = strata::generate_doubles(2, row.stratum, of_doubles, i);
      const bool doubles_intersect = oracle::cgal_verdict(doubles) == Verdict::intersects;
      ASSERT_EQ(doubles_intersect, oracle::gmp_contact(doubles) != Contact::none) << row.id << i;
      of_doubles_intersecting += doubles_intersect;
    }
    const bool shared = row.kind == strata::Kind::shared_vertex || row.kind == strata::Kind::shared_edge;
    EXPECT_GT(intersecting, 200) << row.id;
    EXPECT_EQ(intersecting == 10'000, shared) << row.id << intersecting;
    EXPECT_GT(of_doubles_intersecting, 200) << row.id;
    EXPECT_EQ(of_doubles_intersecting == 10'000, shared) << row.id << of_doubles_intersecting;
  }
}

}  // namespace
}  // namespace graze::analysis
