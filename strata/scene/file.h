// SPDX-License-Identifier: Apache-2.0
// A scene file as a user writes it: at least two lines of TOML. docs/formats.md describes the format.
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
#include "strata/strata.h"

namespace graze::strata {

// The names of the kinds, in the order of the enumerators.
inline constexpr int kKinds = 5;
inline constexpr std::array<std::string_view, kKinds> kKindIds{"general", "shared_vertex", "shared_edge", "coplanar",
                                                               "degenerate"};

// All coordinates are multiples of 2^places or, if decimal, have `places` decimals.
struct GridSpec {
  bool decimal = false;
  int places = 0;
  friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

struct SceneMeshes {
  std::vector<std::string> files;  // relative to the folder of the scene's file
  std::string poses;               // path of a CSV file; empty for none
  std::uint64_t content = 0;       // FNV-1a over the bytes of all these files
  friend bool operator==(const SceneMeshes&, const SceneMeshes&) = default;
};

// The initial values are the defaults for fields that a file may omit. The fields extent and edges have no default.
struct SceneFile {
  std::string units = "units";
  bool in_doubles = false;                        // the coordinates are doubles, not float32
  std::array<std::array<double, 2>, 3> extent{};  // least and greatest coordinate on each axis
  std::vector<double> edges;                      // 1, 2, 3, 5, 9, 17 or 33 quantiles of the longest edges
  std::vector<double> aspect{1.2, 2, 10};         // quantiles of the longest edge divided by its height
  std::optional<GridSpec> grid;
  std::array<double, kKinds> mix{0.6, 0.1, 0.1, 0.15, 0.05};  // share of each Kind among pairs whose boxes overlap
  std::map<Bucket, double> margins;  // these pairs' shares by margin; for information, not for drawing
  SceneMeshes meshes;
  friend bool operator==(const SceneFile&, const SceneFile&) = default;
};

// The rule for a scene's units, in words and as a check.
inline const std::string kUnits = "at most 32 bytes without control characters";
bool is_units(std::string_view text);

// Throws: std::runtime_error with one line: FILE:LINE: expected …, found ….
SceneFile read_scene(const std::filesystem::path& file);
SceneFile parse_scene(const std::string& name, std::string_view text);

// Reading this text gives the same scene, and the same scene always gives the same text.
std::string scene_text(const SceneFile& scene);

// "arm.toml#0123456789abcdef": the file's name, and a hash of its content, ignoring comments and the order of fields.
std::string scene_name(const std::string& file, const SceneFile& scene);

}  // namespace graze::strata
