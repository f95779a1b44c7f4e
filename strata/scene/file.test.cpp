// SPDX-License-Identifier: Apache-2.0
// Tests scene files: a written scene is read back unchanged, two handwritten lines suffice, and errors name a line.
#include "strata/scene/file.h"

#include <gtest/gtest.h>

#include <string>

#include "core/message_testing.h"
#include "strata/scene/envelope.h"

namespace graze::strata {
namespace {

std::string error_of(const std::string& text) {
  try {
    parse_scene("s.toml", text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

const std::string kThree = "extent = [[-400, 400], [-400, 400], [0, 900]]\nedges = [0.5, 40]\nunits = \"mm\"\n";

TEST(SceneFile, ThreeLinesAreEnough) {
  const SceneFile scene = parse_scene("s.toml", kThree);
  EXPECT_EQ(scene.units, "mm");
  EXPECT_EQ(scene.extent[2], (std::array<double, 2>{0, 900}));
  EXPECT_EQ(scene.edges, (std::vector<double>{0.5, 40}));
  const SceneFile defaults;
  EXPECT_EQ(scene.aspect, defaults.aspect);
  EXPECT_EQ(scene.mix, defaults.mix);
  EXPECT_FALSE(scene.grid);
  const Scene numbers = resolved(scene);
  EXPECT_EQ(numbers.high.z, 900);
  EXPECT_EQ(numbers.edges.at[0], 0.5);
  EXPECT_NEAR(numbers.edges.at[16], std::sqrt(0.5 * 40), 1e-12);  // log-spaced between the file's quantiles
  EXPECT_EQ(numbers.edges.at[32], 40);
}

TEST(SceneFile, OneIntervalStandsForThreeAndANumberForAllQuantiles) {
  const SceneFile scene = parse_scene("s.toml", "extent = [-1, 1]\nedges = 0.25");
  for (const auto& axis : scene.extent) EXPECT_EQ(axis, (std::array<double, 2>{-1, 1}));
  EXPECT_EQ(resolved(scene).edges.at[7], 0.25);
}

TEST(SceneFile, WhatIsWrittenIsRead) {
  SceneFile scene = parse_scene("s.toml", kThree);
  scene.units = "\"µm\"\\";
  scene.extent[0] = {-0.1, 0x1.fffffep90};
  scene.edges = {0x1p-149, 1e-5, 1, 40, 1e20};
  scene.grid = GridSpec{true, 3};
  scene.mix = {0.25, 0, 0.125, 1e-7, 0.6};
  scene.margins = {{Bucket{0}, 0.5}, {Bucket{5}, 1e-6}, {Bucket{-64}, 0.25}};
  scene.meshes = {{"a \"b\".off", "ü.ply"}, "", 0x0123456789abcdefu};
  for (const bool bare : {false, true}) {
    if (bare) {
      scene.grid = std::nullopt;
      scene.margins.clear();
      scene.meshes = {};
    } else {
      scene.extent[0] = {-0.1, 1e9};  // a grid of thousandths limits the extent
      scene.edges = {0x1p-149, 1e-5, 1, 40, 1e8};
    }
    const std::string text = scene_text(scene);
    EXPECT_EQ(parse_scene("s.toml", text), scene) << text;
    EXPECT_EQ(scene_text(parse_scene("s.toml", text)), text);
  }
  EXPECT_EQ(scene_name("a/s.toml", scene),
            scene_name("a/s.toml", parse_scene("b", "# a comment\n" + scene_text(scene))));
  const std::string before = scene_name("s.toml", scene);
  scene.edges[1] *= 2;
  EXPECT_NE(before, scene_name("s.toml", scene));
}

TEST(SceneFile, SaysWhichTypeItsCoordinatesHave) {
  const std::string utm = "extent = [[500000.01, 500000.02], [0, 1], [0, 1]]\nedges = [0.01, 1]\n";
  EXPECT_FALSE(parse_scene("s", utm).in_doubles);
  EXPECT_FALSE(parse_scene("s", "coordinates = \"f32\"\n" + utm).in_doubles);
  EXPECT_EQ(scene_text(parse_scene("s", "coordinates = \"f32\"\n" + utm)), scene_text(parse_scene("s", utm)));
  const SceneFile doubles = parse_scene("s", "coordinates = \"f64\"\n" + utm);
  EXPECT_TRUE(doubles.in_doubles);
  EXPECT_EQ(resolved(doubles).low.x, 500000.01);
  EXPECT_EQ(resolved(parse_scene("s", utm)).low.x, 500000);
  EXPECT_EQ(parse_scene("s", scene_text(doubles)), doubles);
  EXPECT_NE(scene_name("s", doubles), scene_name("s", parse_scene("s", utm)));
  // float32 would turn these triangles into points.
  const std::string fine = "extent = [1e6, 2e6]\nedges = [0.125, 0.5]";
  EXPECT_TRUE(names(error_of(fine), {"s.toml:2", "8 ulps"}));
  EXPECT_EQ(error_of("coordinates = \"f64\"\n" + fine), "none");
  EXPECT_TRUE(names(error_of("coordinates = \"f64\"\nextent = [1e6, 2e6]\nedges = 1e-10"), {"s.toml:3", "8 ulps"}));
  for (const char* wrong : {"\"f16\"", "64", "true"})
    EXPECT_TRUE(names(error_of(std::string("coordinates = ") + wrong + "\n" + fine), {"s.toml:1", "f32", "f64"}));
}

TEST(SceneFile, MistakesAreNamedByTheirLine) {
  const std::string edges = "edges = [0.5, 40]\n";
  const std::string extent = "extent = [-400, 400]\n";
  const auto expect_named = [](const std::string& text, const std::vector<std::string>& words) {
    EXPECT_TRUE(names(error_of(text), words)) << text;
  };
  expect_named(extent, {"s.toml:1", "edges"});
  expect_named(edges, {"s.toml:1", "extent"});
  expect_named(kThree + "\nextend = 3\n",
               {"s.toml:5", "extend", "extent", "units", "coordinates", "aspect", "grid", "mix", "margins"});
  expect_named("extent = [[0, 1], [3, 2], [0, 1]]\n" + edges, {"s.toml:1", "3", "2"});
  expect_named("extent = [[0, 1], [0, 2]]\n" + edges, {"s.toml:1", "x", "y", "z", "2"});
  expect_named("extent = [nan, 1]\n" + edges, {"s.toml:1", "nan"});
  expect_named("extent = [0, inf]\n" + edges, {"s.toml:1", "inf"});
  expect_named("extent = [0, 0]\n" + edges, {"s.toml:1", "extent", "point"});
  expect_named("extent = [0, 3]\n" + edges, {"s.toml:2", "edges", "extent", "5.19615", "40"});
  expect_named(extent + "edges = [1, 2, 3, 4]", {"s.toml:2", "33", "4"});
  expect_named(extent + "edges = [1,\n 0.5]", {"s.toml:3", "1", "0.5"});
  expect_named(extent + "edges = \"long\"", {"s.toml:2", "long"});
  expect_named(extent + edges + "aspect = [0.5, 3]", {"s.toml:3", "1.1547", "0.5"});
  expect_named(extent + edges + "grid = { decimals = 3.5 }", {"s.toml:3", "0", "15", "3.5"});
  expect_named(extent + edges + "grid = 3", {"s.toml:3", "power_of_two", "decimals", "3"});
  expect_named(extent + edges + "grid = { decimals = 15 }", {"s.toml:3", "grid", "2^48", "4e+17"});
  expect_named(extent + edges + "grid = { power_of_two = 20 }", {"s.toml:3", "grid", "extent"});
  const std::string whole = "grid = { decimals = 0 }";
  expect_named("extent = [[0.4, 0.6], [0, 90], [0, 90]]\n" + edges + whole, {"s.toml:3", "grid", "in x"});
  expect_named("extent = [[0, 90], [0.2, 0.3], [0, 90]]\n" + edges + whole, {"s.toml:3", "grid", "in y"});
  EXPECT_EQ(error_of("extent = [[0, 90], [0.1, 0.1], [0, 90]]\n" + edges + "grid = { decimals = 1 }"), "none");
  expect_named("extent = [1e6, 2e6]\nedges = [0.125, 0.5]", {"s.toml:2", "edge", "1", "8 ulps", "0.5"});
  expect_named(extent + edges + "[mix]\ngeneral = 0\n", {"s.toml:3", "share", "0"});
  expect_named(extent + edges + "[mix]\ncoplaner = 1\n", {"s.toml:4", "coplaner", "coplanar"});
  expect_named(extent + edges + "[mix]\ngeneral = -1\n", {"s.toml:4", "0", "1", "-1"});
  expect_named(extent + edges + "[margins]\n\"2^3\" = 1\n", {"s.toml:4", "margin", "2^3"});
  expect_named(extent + edges + "[meshes]\nfiles = [\"a.off\"]\n", {"s.toml:3", "content", "graze scene"});
  expect_named("extent = [1, 2\nedges", {"s.toml:2", "TOML"});
  expect_named(extent + extent, {"s.toml:2", "TOML"});
}

TEST(SceneFile, HostileTextsAreOneLine) {
  std::string keys = kThree;
  for (int i = 0; i < 40'000; ++i) keys += "k" + std::to_string(i) + " = 1\n";
  EXPECT_EQ(error_of(keys).rfind("s.toml:4: expected a key of a scene", 0), 0u) << error_of(keys);
  keys.append(1 << 20, '#');
  EXPECT_EQ(error_of(keys), "s.toml: expected a scene of at most 1048576 bytes, found " + std::to_string(keys.size()));
  for (const std::string& text :
       {std::string(100'000, '['), "a = " + std::string(100'000, '['), std::string("\0\0", 2), std::string("\xff\xfe"),
        "a." + std::string(500'000, 'b'), std::string("units = \"\n")}) {
    const std::string error = error_of(text);
    EXPECT_EQ(error.rfind("s.toml:1: expected ", 0), 0u) << error.substr(0, 300);
    EXPECT_LT(error.size(), 400u);
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

// Fuzzing found that non-ASCII characters outside quotes make toml++ reach code that it declares unreachable.
TEST(SceneFile, CharactersBeyondAsciiStandInQuotesAndCommentsAlone) {
  const std::string rest = "extent = [[-4, 4], [0, 8], [1, 2]]\nedges = [0.5, 2]\n";
  EXPECT_EQ(parse_scene("s", "\xef\xbb\xbfunits = \"\u00b5m \\\" \u00e9\" # \u00e9\n" + rest).units,
            "\u00b5m \" \u00e9");
  EXPECT_EQ(parse_scene("s", "units = '\u00b5m' # '\n" + rest).units, "\u00b5m");
  EXPECT_EQ(parse_scene("s", "units = \"\"\"\u00b5m\"\u00e9\"\"\"\n" + rest).units, "\u00b5m\"\u00e9");
  for (const char* text :
       {"\n\u00e9 = 1\n", "#\nunits \ufe7d= 1\n", "\nunits = 1 \u00e9\n", "\nunits = 0[[\"\"\u01bf\n"}) {
    try {
      parse_scene("s", text + rest);
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("s:2: expected TOML, found ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace graze::strata
