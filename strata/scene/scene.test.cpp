// SPDX-License-Identifier: Apache-2.0
// Tests pairs drawn in scenes. Every pair lies within the extent and on the grid, and has the scene's sizes. Strata
// keep their guarantees. Sources get their shares of the mix. Strata that do not fit are left out with a reason.
#include "strata/scene/scene.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/message_testing.h"
#include "core/relation_of.h"
#include "strata/golden.h"
#include "strata/groups.h"
#include "strata/mesh.h"
#include "strata/scene/envelope.h"
#include "strata/scene/sources.h"
#include "strata/testing.h"

namespace graze::strata {
namespace {

using testing::converted;
using testing::edge;
using testing::length;
using testing::normal;
using testing::shared_vertices;

// Several kinds of scene: in millimetres far from the origin, on a grid of thousandths; on a coarse grid; flat; and
// without a grid.
const std::pair<const char*, const char*> kScenes[] = {
    {"millimetres",
     "extent = [[120000, 120800], [-5400, -5000], [300, 900.5]]\nedges = [0.5, 40]\n"
     "aspect = [1.2, 4, 3000]\ngrid = { decimals = 3 }"},
    {"coarse", "extent = [-20, 20]\nedges = [1, 9]\ngrid = { power_of_two = -1 }"},
    {"eighths",
     "extent = [[-3000.1, 4000.7], [0.125, 9000], [5, 700]]\nedges = [2, 300]\ngrid = { power_of_two = -3 }"},
    {"terrain", "extent = [[0, 40000], [0, 40000], [180, 240]]\nedges = [20, 60]"},
    {"plane", "extent = [[0, 10], [0, 10], [2.5, 2.5]]\nedges = [0.01, 3]"},
    {"free", "extent = [-1, 1]\nedges = [0.001, 0.2]\naspect = [1.2, 3, 5000]"},
    {"uneven", "extent = [[1e6, 2e6], [0.01, 0.02], [-7, 5]]\nedges = [2, 3000]"},
    {"tiny", "extent = [-1e-40, 3e-40]\nedges = [1e-41, 1e-40]"},
    {"huge", "extent = [-8e37, 8e37]\nedges = [1e30, 6e37]"},
};

double longest(const Vec3<float> (&v)[3]) {
  const auto t = converted<double>(v);
  return std::max({length(edge(t, 0)), length(edge(t, 1)), length(edge(t, 2))});
}

double longest(const Vec3<double> (&v)[3]) {
  return std::max({length(v[1] - v[0]), length(v[2] - v[1]), length(v[0] - v[2])});
}

// Whether the pair is within the extent and on the grid, and no edge is longer than `most`.
template <class Real>
::testing::AssertionResult is_of_scene(const SceneFile& file, const Scene& scene, double most,
                                       const BasicPair<Real>& pair) {
  for (int k = 0; k < kCoordinates; ++k) {
    const auto x = static_cast<double>(coordinates(pair)[k]);
    const auto& [low, high] = file.extent[static_cast<std::size_t>(k % 3)];
    if (!(static_cast<double>(static_cast<Real>(low)) <= x && x <= static_cast<double>(static_cast<Real>(high))))
      return ::testing::AssertionFailure() << x << " not in " << low << ' ' << high;
    const double on_grid = file.grid ? in_scene::point_of(scene.grid, in_scene::number_of(scene.grid, x)) : x;
    if (static_cast<double>(static_cast<Real>(on_grid)) != x)
      return ::testing::AssertionFailure() << x << " is not on the grid";
  }
  if (!(longest(pair.a) <= most && longest(pair.b) <= most))
    return ::testing::AssertionFailure() << longest(pair.a) << " or " << longest(pair.b) << " is longer than " << most;
  return ::testing::AssertionSuccess();
}

TEST(Scene, EveryPairIsWithinTheExtentOnTheGridAndOfTheSizes) {
  constexpr std::uint64_t kPairs = 100'000;
  for (const auto& [name, text] : kScenes) {
    const SceneFile file = parse_scene(name, text);
    const Scene scene = resolved(file);
    double ulp = 0;
    for (const auto& [low, high] : file.extent)
      ulp = std::max(
          ulp, std::ldexp(1.0, log2_ulp(Pair{{{static_cast<float>(low), static_cast<float>(high), 0}, {}, {}}, {}})));
    const double step =
        std::max(ulp, scene.on_grid ? (scene.grid.decimal ? 1 / scene.grid.scale : scene.grid.scale) : 0);
    const double most = scene.edges.at[kQuantiles - 1] * 1.00001 + 20 * step;  // rounding, and pushes by 8 steps
    int drawn = 0;
    for (const StratumInfo& row : kStrata) {
      if (left_out(file, row.stratum)) continue;
      ++drawn;
      std::set<std::uint64_t> kinds;
      for (std::uint64_t i = 0; i < kPairs; ++i) {
        const Pair pair = generate(3, row.stratum, scene, i);
        ASSERT_TRUE(is_of_scene(file, scene, most, pair)) << name << ' ' << row.id << ':' << i;
        if (i < 1000) kinds.insert(hash_bits(pair));
      }
      EXPECT_GT(kinds.size(), 900u) << name << ' ' << row.id;  // nearly all pairs differ
    }
    EXPECT_GE(drawn, 11) << name;
  }
}

TEST(Scene, SizesAreThoseOfTheQuantiles) {
  const Scene scene =
      resolved(parse_scene("s", "extent = [-100, 100]\nedges = [0.1, 1, 2, 4, 9]\naspect = [1.2, 1.5, 40]"));
  for (const Stratum stratum :
       {Stratum::uniform, Stratum::near_vertex_face, Stratum::near_edge_edge, Stratum::near_vertex_edge,
        Stratum::near_vertex_vertex, Stratum::coplanar_rounded, Stratum::shared_vertex, Stratum::shared_edge}) {
    std::vector<double> edges, aspects;
    for (std::uint64_t i = 0; i < 100'000; ++i) {
      const Pair pair = generate(1, stratum, scene, i);
      for (const auto* v : {&pair.a, &pair.b}) {
        const double l = longest(*v);
        edges.push_back(l);
        aspects.push_back(l * l / length(normal(converted<double>(*v))));
      }
    }
    std::sort(edges.begin(), edges.end());
    std::sort(aspects.begin(), aspects.end());
    for (std::size_t q = 1; q < 8; ++q) {
      EXPECT_NEAR(edges[edges.size() * q / 8] / scene.edges.at[4 * q], 1, 0.05)
          << static_cast<int>(stratum) << ' ' << q;
      EXPECT_NEAR(aspects[aspects.size() * q / 8] / scene.aspect.at[4 * q], 1, 0.05)
          << static_cast<int>(stratum) << ' ' << q;
    }
  }
}

TEST(Scene, SliversAreSlivers) {
  const Scene scene = resolved(parse_scene("s", "extent = [-100, 100]\nedges = [1, 9]\naspect = [1.2, 2, 20000]"));
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const Pair pair = generate(1, Stratum::sliver, scene, i);
    double most = 0;
    for (const auto* v : {&pair.a, &pair.b})
      most = std::max(most, longest(*v) * longest(*v) / length(normal(converted<double>(*v))));
    ASSERT_GT(most, 950) << i;  // 1024, rounded to ulps of 100
  }
}

TEST(Scene, ExactStrataAreExact) {
  const SceneFile file = parse_scene("s", kScenes[2].second);
  const Scene scene = resolved(file);
  const auto whole = [&](const Vec3<float>(&v)[3]) {
    testing::Triangle<testing::Int> t;
    for (std::size_t i = 0; i < 3; ++i)
      t[i] = {static_cast<testing::Int>(v[i].x * 8), static_cast<testing::Int>(v[i].y * 8),
              static_cast<testing::Int>(v[i].z * 8)};
    return t;
  };
  int touching = 0, coplanar = 0, axis_plane = 0, tilted = 0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const Pair contact = generate(1, Stratum::exact_contact, scene, i);
    touching += !testing::disjoint(whole(contact.a), whole(contact.b));
    const Pair wide = generate(1, Stratum::coplanar_wide, scene, i);
    coplanar += testing::is_coplanar(whole(wide.a), whole(wide.b));
    tilted +=
        testing::extent_along(wide, 0) > 0 && testing::extent_along(wide, 1) > 0 && testing::extent_along(wide, 2) > 0;
    const Pair lattice = generate(1, Stratum::coplanar_lattice, scene, i);
    axis_plane += testing::extent_along(lattice, 0) == 0 || testing::extent_along(lattice, 1) == 0 ||
                  testing::extent_along(lattice, 2) == 0;
  }
  EXPECT_EQ(coplanar, 10'000);
  EXPECT_GT(tilted, 7'000);
  EXPECT_EQ(axis_plane, 10'000);
  testing::expect_between(5'000, 9'000, touching);  // exact contacts, and some of the pairs pushed by a step
}

TEST(Scene, NeighboursShareTheirVerticesBitForBit) {
  for (const auto& [name, text] : kScenes) {
    const Scene scene = resolved(parse_scene(name, text));
    for (std::uint64_t i = 0; i < 5'000; ++i) {
      ASSERT_GE(shared_vertices(generate(1, Stratum::shared_vertex, scene, i)), 1) << name << ' ' << i;
      ASSERT_GE(shared_vertices(generate(1, Stratum::shared_edge, scene, i)), 2) << name << ' ' << i;
    }
  }
}

TEST(Scene, SameBytesAsEver) {
  const Scene scene = resolved(parse_scene(kScenes[0].first, kScenes[0].second));
  std::uint64_t hash = kHashStart;
  for (const StratumInfo& row : kStrata) {
    if (left_out(parse_scene(kScenes[0].first, kScenes[0].second), row.stratum)) continue;
    for (std::uint64_t i = 0; i < 1000; ++i) hash = hash_bits(generate(kGoldenSeed, row.stratum, scene, i), hash);
  }
  EXPECT_EQ(hash, 0xdc88fa2cdcf2a5e5u) << std::hex << hash;  // if this changes, every case from a scene changes too
}

// The same scenes in doubles, and a site survey in millimetres, whose grid float32 cannot hold.
std::vector<std::pair<std::string, SceneFile>> double_scenes() {
  std::vector<std::pair<std::string, SceneFile>> scenes;
  for (const auto& [name, text] : kScenes)
    scenes.emplace_back(name, parse_scene(name, std::string("coordinates = \"f64\"\n") + text));
  scenes.emplace_back("survey", parse_scene("survey",
                                            "coordinates = \"f64\"\nextent = [[500000, 500300.5], [5400000, "
                                            "5400300], [0.001, 60]]\nedges = [0.02, 30]\ngrid = { decimals = 3 }"));
  return scenes;
}

double largest_of(const SceneFile& file) {
  double largest = 0;
  for (const auto& [low, high] : file.extent) largest = std::max({largest, std::fabs(low), std::fabs(high)});
  return largest;
}

TEST(DoubleScene, EveryPairIsWithinTheExtentOnTheGridAndOfTheSizes) {
  constexpr std::uint64_t kPairs = 20'000;
  for (const auto& [name, file] : double_scenes()) {
    const Scene scene = resolved(file);
    const double ulp = ulp_of(file, largest_of(file));
    const double step =
        std::max(ulp, scene.on_grid ? (scene.grid.decimal ? 1 / scene.grid.scale : scene.grid.scale) : 0);
    const double most = scene.edges.at[kQuantiles - 1] * (1 + 0x1p-40) + 20 * step;
    int drawn = 0;
    for (const StratumInfo& row : kDoubleStrata) {
      if (left_out(file, row.stratum)) continue;
      ++drawn;
      std::set<std::uint64_t> kinds;
      int finer = 0;
      for (std::uint64_t i = 0; i < kPairs; ++i) {
        const DoublePair pair = generate_doubles(3, row.stratum, scene, i);
        ASSERT_TRUE(is_of_scene(file, scene, most, pair)) << name << ' ' << row.id << ':' << i;
        if (i < 1000) kinds.insert(hash_bits(pair));
        finer += hash_bits(in_doubles(stored_in_float32(pair))) != hash_bits(pair);
      }
      EXPECT_GT(kinds.size(), 900u) << name << ' ' << row.id;  // nearly all pairs differ
      if (!file.grid || name == "survey") {
        EXPECT_GT(finer, 0.99 * kPairs) << name << ' ' << row.id;
      }
    }
    EXPECT_GE(drawn, 11) << name;
  }
}

// Whether moving one coordinate by a step makes the triangles touch.
bool touches_a_step_away(const DoublePair& pair, double step) {
  for (int k = 0; k < kCoordinates; ++k) {
    for (const double by : {step, -step}) {
      DoublePair moved = pair;
      coordinates(moved)[k] += by;
      if (relation_of(moved).touches()) return true;
    }
  }
  return false;
}

TEST(DoubleScene, ExactStrataAreExact) {
  for (const auto& [name, file] : double_scenes()) {
    const Scene scene = resolved(file);
    if (scene.exact.decimal || left_out(file, Stratum::exact_contact)) continue;
    int touching = 0, inexact = 0, tilted = 0, wide = 0;
    for (std::uint64_t i = 0; i < 10'000; ++i) {
      const DoublePair contact = generate_doubles(1, Stratum::exact_contact, scene, i);
      const bool touches = relation_of(contact).touches();
      touching += touches;
      inexact += i < 2'000 && !touches && !touches_a_step_away(contact, scene.exact.scale);
      const DoublePair coplanar = generate_doubles(1, Stratum::coplanar_wide, scene, i);
      ASSERT_TRUE(relation_of(coplanar).hulls.coplanar) << name << ' ' << i;
      for (const DoublePair& pair : {contact, coplanar}) {
        for (int k = 0; k < kCoordinates; ++k) {
          const double n = coordinates(pair)[k] / scene.exact.scale;
          ASSERT_EQ(n, std::trunc(n)) << name << ' ' << i;
          wide += k == 0 && std::fabs(n) > 0x1p40;
        }
      }
      int spread = 0;
      for (int axis = 0; axis < 3; ++axis) {
        double low = component(coplanar.a[0], axis), high = low;
        for (const auto& v : {coplanar.a[1], coplanar.a[2], coplanar.b[0], coplanar.b[1], coplanar.b[2]}) {
          low = std::min(low, component(v, axis));
          high = std::max(high, component(v, axis));
        }
        spread += high > low;
      }
      tilted += spread == 3;
    }
    EXPECT_LE(inexact, file.grid ? 20 : 0) << name;  // edges of a few steps may be parallel
    EXPECT_GT(touching, 4'850) << name;              // about half of the pairs touch
    if (name != "plane") {                           // all pairs of that scene are coplanar
      EXPECT_LT(touching, 7'000) << name;
      EXPECT_GT(tilted, 7'000) << name;
    }
    if (!file.grid) {
      EXPECT_GT(wide, 10'000) << name;
    }
  }
}

TEST(DoubleScene, APointOfADecimalGridIsTheNearestDouble) {
  const auto [name, file] = double_scenes().back();
  const Scene scene = resolved(file);
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const DoublePair pair = generate_doubles(1, Stratum::near_edge_edge, scene, i);
    for (int k = 0; k < kCoordinates; ++k) {
      const double x = coordinates(pair)[k];
      char decimal[64];
      std::snprintf(decimal, sizeof decimal, "%.3f", x);
      ASSERT_EQ(std::strtod(decimal, nullptr), x) << i;
    }
  }
}

TEST(DoubleScene, NeighboursShareTheirVerticesBitForBit) {
  for (const auto& [name, file] : double_scenes()) {
    const Scene scene = resolved(file);
    for (std::uint64_t i = 0; i < 5'000; ++i) {
      ASSERT_GE(shared_vertices(generate_doubles(1, Stratum::shared_vertex, scene, i)), 1) << name << ' ' << i;
      ASSERT_GE(shared_vertices(generate_doubles(1, Stratum::shared_edge, scene, i)), 2) << name << ' ' << i;
    }
  }
}

TEST(DoubleScene, SameBytesAsEver) {
  std::uint64_t hash = kHashStart;
  for (const auto& [name, file] : double_scenes()) {
    const Scene scene = resolved(file);
    for (const StratumInfo& row : kDoubleStrata) {
      if (left_out(file, row.stratum)) continue;
      for (std::uint64_t i = 0; i < 100; ++i)
        hash = hash_bits(generate_doubles(kGoldenSeed, row.stratum, scene, i), hash);
    }
  }
  EXPECT_EQ(hash, 0xd9b008bd3258f4a9u) << std::hex << hash;
}

std::string why(const char* text, Stratum stratum) {
  return left_out(parse_scene("s", text), stratum).value_or("drawn");
}

TEST(Scene, WhatItCannotContainIsLeftOutWithTheReason) {
  const char* mm = "extent = [[0.003, 410], [5, 80], [7, 9]]\nedges = [0.5, 4]\nunits = \"mm\"";
  EXPECT_EQ(why(mm, Stratum::far_from_origin), "your coordinates stay within 0.003 … 410 mm");
  EXPECT_EQ(why(mm, Stratum::extreme_scale),
            "your coordinates stay within 0.003 … 410 mm, and your triangles' longest edges within 0.5 … 4");
  EXPECT_EQ(why(mm, Stratum::thesis), "its triangles have fixed coordinates, not those of a scene");
  EXPECT_EQ(why(mm, Stratum::mixed_scale), "your triangles' longest edges differ by a factor of 8, less than 16");
  EXPECT_EQ(why("extent = [0, 99]\nedges = [0.5, 40]", Stratum::mixed_scale), "drawn");
  EXPECT_EQ(why(mm, Stratum::sliver), "your aspect ratios stay within 1.2 … 10, below 1024");
  EXPECT_EQ(why(mm, Stratum::lattice), "your scene has no grid");
  EXPECT_EQ(why(mm, Stratum::exact_contact), "drawn");
  EXPECT_EQ(why("extent = [90000, 99000]\nedges = [0.1, 0.3]", Stratum::exact_contact),
            "your longest edge spans 38.4 ulps of your largest coordinate, fewer than 64");
  EXPECT_EQ(why(kScenes[6].second, Stratum::exact_contact),
            "your extent contains no multiple of 0.125 (one ulp of your largest coordinate) along y");
  EXPECT_EQ(why(kScenes[1].second, Stratum::coplanar_wide), "your longest edge spans 18 grid steps, fewer than 64");
  EXPECT_EQ(why(kScenes[1].second, Stratum::lattice), "drawn");
  EXPECT_EQ(why(kScenes[2].second, Stratum::lattice), "your longest edge spans 2.4e+03 grid steps, more than 64");
  EXPECT_EQ(why("extent = [0, 9]\nedges = 1\n[mix]\ngeneral = 1", Stratum::degenerate),
            "your mix has no pairs of the kind degenerate");
}

TEST(DoubleScene, StrataOfDoublesAloneAreLeftOutWithTheReason) {
  const char* survey = "coordinates = \"f64\"\nextent = [[500000, 500300], [9, 80], [7, 9]]\nedges = [0.5, 4]";
  EXPECT_EQ(why(survey, Stratum::large_offset), "your coordinates stay within 7 … 500300 units");
  EXPECT_EQ(why(survey, Stratum::radians), "your coordinates stay within 7 … 500300 units");
  for (const Stratum stratum :
       {Stratum::lattice_15, Stratum::float_born, Stratum::decimal_born, Stratum::construction_born, Stratum::stored})
    EXPECT_EQ(why(survey, stratum), "its triangles have their own sizes, not those of a scene");
  EXPECT_EQ(why(survey, Stratum::exact_contact), "drawn");
}

TEST(SceneSources, AreThoseOfTheType) {
  const SceneFile file = parse_scene("s", "extent = [0, 9]\nedges = [0.5, 1]");
  const SceneFile fine =
      parse_scene("s", "coordinates = \"f64\"\nextent = [[500000, 500009], [0, 9], [0, 9]]\nedges = [0.01, 0.2]");
  for (const PairSource& source : scene_sources(file, "", 1, 100, {}).sources) EXPECT_FALSE(source.in_doubles());
  for (const PairSource& source : scene_sources(fine, "", 1, 100, {}).sources) {
    EXPECT_TRUE(source.in_doubles() && source.id.ends_with("/f64") && source.stratum >= 0 && source.scene) << source.id;
    EXPECT_EQ(group_of_name(source.id), group_of_name(source.id.substr(0, source.id.size() - 4)));
  }
  // At 500000, float32 numbers are 1/32 apart.
  try {
    scene_sources(fine, "", 1, 100, {}, PairTypes::f32);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_TRUE(names(error.what(), {"float32", "0.25", "8 ulps", "0.2", "doubles"})) << error.what();
  }
  // Sources of both types get pairs, and the shares add up.
  const SceneSources both = scene_sources(file, "", 1, 10'001, {"near_*", "uniform/f64"}, PairTypes::both);
  ASSERT_EQ(both.sources.size(), 9u);
  std::vector<std::string> ids;
  std::uint64_t sum = 0;
  for (const PairSource& source : both.sources) {
    ids.push_back(source.id);
    sum += source.pairs;
  }
  EXPECT_EQ(sum, 10'001u);
  EXPECT_EQ(both.sources[0].id, "near_vertex_face");
  EXPECT_EQ(hash_bits(both.sources[0].pair(5)), hash_bits(generate(1, Stratum::near_vertex_face, resolved(file), 5)));
  EXPECT_EQ(both.sources[4].id, "uniform/f64");
  EXPECT_EQ(hash_bits(both.sources[4].double_pair(5)),
            hash_bits(generate_doubles(1, Stratum::uniform, resolved(with_type(file, true)), 5)));
  // A campaign can find the same sources again from their names.
  const SceneSources again = named_scene_sources(file, "", 1, 10'001, ids);
  ASSERT_EQ(again.sources.size(), ids.size());
  for (std::size_t s = 0; s < ids.size(); ++s) {
    EXPECT_EQ(again.sources[s].id, ids[s]);
    EXPECT_EQ(again.sources[s].pairs, both.sources[s].pairs);
  }
  EXPECT_EQ(named_scene_sources(file, "", 1, 100, {"uniform"}).sources.size(), 1u);
  EXPECT_THROW(scene_sources(file, "", 1, 7, {"uniform/f64"}), UsageError);
}

TEST(SceneSources, AreSharedByTheMix) {
  const SceneFile file = parse_scene("s", "extent = [0, 9]\nedges = 1\n[mix]\ngeneral = 0.6\nshared_edge = 0.4");
  const SceneSources all = scene_sources(file, "", 1, 100'000, {});
  std::map<std::string, std::uint64_t> pairs;
  std::uint64_t sum = 0;
  for (const PairSource& source : all.sources) {
    pairs[source.id] = source.pairs;
    sum += source.pairs;
    EXPECT_TRUE(source.stratum >= 0 && source.scene && source.seed == 1) << source.id;
  }
  EXPECT_EQ(sum, 100'000u);
  EXPECT_EQ(pairs.size(), 7u);  // uniform, four near strata, exact_contact and shared_edge
  EXPECT_EQ(pairs["uniform"], 10'000u);
  EXPECT_EQ(pairs["shared_edge"], 40'000u);
  EXPECT_EQ(all.left_out.size(), kStrataCount - 7u);
  const SceneSources one = scene_sources(file, "", 1, 7, {"near_*", "sliver"});
  EXPECT_EQ(one.sources.size(), 4u);
  EXPECT_EQ(one.left_out.size(), 1u);
  EXPECT_THROW(scene_sources(file, "", 1, 7, {"nearly"}), UsageError);
  EXPECT_THROW(scene_sources(file, "", 1, 7, {"sliver", "mesh"}), UsageError);
  EXPECT_THROW(scene_sources(file, "", 1, 7, {"sliver", "!sliver"}), UsageError);
}

class SceneMesh : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    std::ofstream off(folder_ / "m.off");
    off << "OFF\n36 50 0\n";  // a bumpy sheet of 6 * 6 vertices
    for (int i = 0; i < 36; ++i) off << 100 + i % 6 << ' ' << i / 6 << ' ' << i * i % 7 << '\n';
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 5; ++j) {
        const int v = 6 * i + j;
        off << "3 " << v << ' ' << v + 1 << ' ' << v + 7 << "\n3 " << v << ' ' << v + 7 << ' ' << v + 6 << '\n';
      }
    }
    off.close();
    file_ = parse_scene("s", "extent = [[100, 105], [0, 5], [0, 6]]\nedges = [1, 6]");
    file_.meshes = {{"m.off"}, "", read_bodies({folder_ / "m.off"}).content_hash};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("graze_scene_" + std::to_string(getpid()));
  SceneFile file_;
};

TEST_F(SceneMesh, ItsPairsAreDrawnAsTheyAreByUlpsAndByMotions) {
  const MeshPairs own = read_bodies({folder_ / "m.off"});
  const SceneSources drawn = scene_sources(file_, folder_, 5, 30'000, {"mesh*"});
  ASSERT_EQ(drawn.sources.size(), 3u);
  EXPECT_EQ(drawn.sources[0].pairs, own.size());  // each pair once, in another order
  std::set<std::uint64_t> seen, all;
  for (std::size_t i = 0; i < own.size(); ++i) {
    seen.insert(hash_bits(drawn.sources[0].pair(i)));
    all.insert(hash_bits(own.pair(i)));
  }
  EXPECT_EQ(seen, all);
  int moved = 0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const Pair by_ulps = drawn.sources[1].pair(i), by_motion = drawn.sources[2].pair(i);
    for (const Pair& pair : {by_ulps, by_motion}) {
      for (int k = 0; k < kCoordinates; ++k) {
        const auto& [low, high] = file_.extent[static_cast<std::size_t>(k % 3)];
        ASSERT_TRUE(low <= coordinates(pair)[k] && coordinates(pair)[k] <= high) << i;
      }
      // Motions are rigid up to rounding, so each triangle is congruent to one of the mesh's triangles.
      ASSERT_TRUE(std::any_of(own.triangles.begin(), own.triangles.end(), [&](const auto& t) {
        double d[2][3];
        for (std::size_t e = 0; e < 3; ++e) {
          d[0][e] = length(edge(converted<double>(pair.a), e));
          d[1][e] = length(edge(
              testing::Triangle<double>{converted<double>(t[0]), converted<double>(t[1]), converted<double>(t[2])}, e));
        }
        for (auto& lengths : d) std::sort(std::begin(lengths), std::end(lengths));
        return std::equal(d[0], d[0] + 3, d[1], [](double x, double y) { return std::fabs(x - y) < 1e-3; });
      })) << i;
    }
    moved += !all.count(hash_bits(by_motion));
  }
  EXPECT_GT(moved, 9'900);
}

TEST_F(SceneMesh, ItsDoublesAreDrawnAsTheyAreByUlpsAndByMotions) {
  {
    std::ifstream in(folder_ / "m.off");
    std::string text((std::istreambuf_iterator<char>(in)), {});
    for (std::size_t at = text.find("\n10"); at < text.size(); at = text.find("\n10", at + 1))
      text.replace(at, 3, "\n5400000.010");  // 100 becomes 5400000.0100, 105 5400000.0105
    std::ofstream(folder_ / "far.off") << text;
  }
  const MeshPairs own = read_bodies({folder_ / "far.off"});
  ASSERT_FALSE(own.in_doubles.empty());
  SceneFile file =
      parse_scene("s", "coordinates = \"f64\"\nextent = [[5400000.01, 5400000.0105], [0, 5], [0, 6]]\nedges = [1, 6]");
  file.meshes = {{"far.off"}, "", own.content_hash};
  const SceneSources drawn = scene_sources(file, folder_, 5, 30'000, {"mesh*"});
  ASSERT_EQ(drawn.sources.size(), 3u);
  EXPECT_EQ(drawn.sources[0].id, "mesh/f64");
  EXPECT_EQ(drawn.sources[0].pairs, own.size());
  EXPECT_EQ(drawn.notes[0], own.notes_of_doubles[0]);
  std::set<std::uint64_t> seen, all;
  for (std::size_t i = 0; i < own.size(); ++i) {
    seen.insert(hash_bits(drawn.sources[0].double_pair(i)));
    all.insert(hash_bits(own.double_pair(i)));
  }
  EXPECT_EQ(seen, all);
  int moved = 0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    for (const std::size_t s : {1, 2}) {
      const DoublePair pair = drawn.sources[s].double_pair(i);
      for (int k = 0; k < kCoordinates; ++k) {
        const auto& [low, high] = file.extent[static_cast<std::size_t>(k % 3)];
        ASSERT_TRUE(low <= coordinates(pair)[k] && coordinates(pair)[k] <= high) << i;
      }
      moved += !all.count(hash_bits(pair));
    }
  }
  EXPECT_GT(moved, 19'500);
  file.extent[0] = {5400000.01, 5400000.0104};
  EXPECT_THROW(scene_sources(file, folder_, 1, 10, {}), std::runtime_error);
}

TEST_F(SceneMesh, AnotherMeshOrOneOutsideIsRefused) {
  file_.meshes.content ^= 1;
  EXPECT_THROW(scene_sources(file_, folder_, 1, 10, {}), std::runtime_error);
  file_.meshes.content ^= 1;
  file_.extent[1] = {0, 4.5};
  try {
    scene_sources(file_, folder_, 1, 10, {});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(names(error.what(), {"m.off", "extent", "0", "4.5", "y", "5"}));
  }
}

TEST_F(SceneMesh, PosesMakeBodies) {
  const auto write = [&](const char* text) { std::ofstream(folder_ / "p.csv") << text; };
  write("1,0,0,0, 0,1,0,0, 0,0,1,0\n# half a step aside\n1 0 0 0.5 0 1 0 0 0 0 1 0\n");
  const MeshPairs pairs = read_bodies({folder_ / "m.off"}, folder_ / "p.csv");
  EXPECT_EQ(pairs.triangles.size(), 100u);
  EXPECT_EQ(pairs.triangles[50][0].x, pairs.triangles[0][0].x + 0.5f);
  for (const auto& [i, j] : pairs.candidates) ASSERT_TRUE(i < 50 && 50 <= j);
  EXPECT_NE(pairs.content_hash, file_.meshes.content);
  const auto error = [&](const char* text) -> std::string {
    write(text);
    try {
      read_bodies({folder_ / "m.off"}, folder_ / "p.csv");
    } catch (const std::runtime_error& thrown) {
      return thrown.what();
    }
    return "none";
  };
  EXPECT_TRUE(names(error("1 0 0 0\n"), {"p.csv:1", "12 numbers", "end of the line"}));
  EXPECT_TRUE(names(error("1 0 0 0 0 1 0 0 0 0 nan 0\n"), {"p.csv:1", "12 numbers", "\"nan\""}));
  EXPECT_TRUE(names(error("1 0 0 0 0 1 0 0 0 0 1 0 9\n"), {"p.csv:1", "12 numbers", "\"9\""}));
  EXPECT_TRUE(names(error("1 0 0 1e39 0 1 0 0 0 0 1 0\n"), {"p.csv", "pose 1", "float32"}));
  EXPECT_TRUE(names(error("\n"), {"no pose", "p.csv"}));
}

TEST_F(SceneMesh, BodiesArePairedWithEachOtherOnly) {
  std::filesystem::copy(folder_ / "m.off", folder_ / "n.off");
  std::filesystem::copy(folder_ / "m.off", folder_ / "o.off");
  const MeshPairs two = read_bodies({folder_ / "m.off", folder_ / "n.off"});
  const MeshPairs three = read_bodies({folder_ / "m.off", folder_ / "n.off", folder_ / "o.off"});
  EXPECT_EQ(three.candidates.size(), 3 * two.candidates.size());
  for (const auto& [i, j] : three.candidates) ASSERT_NE(i / 50, j / 50);
}

}  // namespace
}  // namespace graze::strata
