// SPDX-License-Identifier: Apache-2.0
// A scene as a person writes it: TOML, two lines at least. docs/formats.md describes the format.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/margin/bucket.h"

namespace graze::strata {

// What a pair of a scene is, by the first that holds: a triangle of no area; two stored vertices in common; one; all
// six points in a plane; anything else.
enum class Kind : std::uint8_t { general, shared_vertex, shared_edge, coplanar, degenerate };
inline constexpr int kKinds = 5;
inline constexpr std::array<std::string_view, kKinds> kKindIds{"general", "shared_vertex", "shared_edge", "coplanar",
                                                               "degenerate"};

// All coordinates are multiples of 2^places, or have so many decimals.
struct GridSpec {
  bool decimal = false;
  int places = 0;
  friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

struct SceneMeshes {
  std::vector<std::string> files;  // relative to the folder of the scene's file
  std::string poses;               // of a CSV file; may be empty
  std::uint64_t content = 0;       // FNV-1a of all of them
  friend bool operator==(const SceneMeshes&, const SceneMeshes&) = default;
};

// The values that stand here are those of what a file leaves out; extent and edges have none.
struct SceneFile {
  std::string units = "units";
  std::array<std::array<double, 2>, 3> extent{};  // least and greatest coordinate by axis
  std::vector<double> edges;                      // of triangles' longest edges: 1, 2, 3, 5, 9, 17 or 33 quantiles
  std::vector<double> aspect{1.2, 2, 10};         // longest edge over the height on it, likewise
  std::optional<GridSpec> grid;
  std::array<double, kKinds> mix{0.6, 0.1, 0.1, 0.15, 0.05};  // shares of the pairs whose boxes overlap, by Kind
  std::map<Bucket, double> margins;                           // share of them, by margin; told, not drawn from
  SceneMeshes meshes;
  friend bool operator==(const SceneFile&, const SceneFile&) = default;
};

// Throws: std::runtime_error of one line: FILE:LINE: expected …, found ….
SceneFile read_scene(const std::filesystem::path& file);
SceneFile parse_scene(const std::string& name, std::string_view text);

// Reading it gives the same scene; the same scene gives the same text.
std::string scene_text(const SceneFile& scene);

// "arm.toml#0123456789abcdef": the file's name and a hash of what it says, comments and order aside.
std::string scene_name(const std::string& file, const SceneFile& scene);

}  // namespace graze::strata
