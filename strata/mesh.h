// SPDX-License-Identifier: Apache-2.0
// Pairs from real input: triangles of one mesh, or of several, whose closed bounding boxes overlap. CGAL finds
// overlapping boxes with its hybrid of streaming and segment trees (Zomorodian and Edelsbrunner 2002).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/pair.h"
#include "strata/mesh_readers/soup.h"
#include "strata/pair_source.h"

namespace graze::strata {

struct MeshPairs {
  std::vector<std::array<Vec3<float>, 3>> triangles;  // of the first file, then of the second
  // The same triangles in doubles. Empty if float32 rounded no coordinate.
  std::vector<std::array<Vec3<double>, 3>> in_doubles;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> candidates;  // indices into triangles, sorted, first < second
  std::uint64_t content_hash = 0;  // FNV-1a of the bytes of the first file, then of the second
  // One line for each file with unused content, such as normals, and one for each file that rounding to float32
  // changes.
  std::vector<std::string> notes;
  std::vector<std::string> notes_of_doubles;  // the same, for callers that use the doubles
  Rounding rounding;                          // how float32 rounded the coordinates of all files

  std::size_t size() const { return candidates.size(); }

  // Requires: index < size().
  Pair pair(std::size_t index) const;
  DoublePair double_pair(std::size_t index) const;

  // All triangles as doubles; a double holds every float32 exactly.
  std::vector<std::array<Vec3<double>, 3>> triangles_in_doubles() const;
};

std::array<Vec3<double>, 3> in_doubles(const std::array<Vec3<float>, 3>& triangle);

// The candidate pairs as a campaign's sources: "mesh" in float32, and "mesh/f64" in doubles.
std::vector<PairSource> mesh_sources(const std::shared_ptr<const MeshPairs>& mesh, PairTypes types);

// Whether the file has the extension of a mesh format.
bool is_mesh(const std::filesystem::path& file);

// "OFF, OBJ, STL or PLY"
std::string mesh_formats();

// The candidate pairs of bodies: one body against itself, or several against each other. Without `poses`, each file is
// a body; with `poses`, each pose of a single mesh is a body. `poses` is a CSV file with twelve numbers per row: the
// three rows of a pose's matrix (R | t).
// A face with more than three vertices is cut into a fan from its first vertex. Each coordinate is rounded once to
// float32; coordinates that change are counted. Triangles that become degenerate are kept. The boxes enclose the
// rounded triangles, so no touching pair is missed. A file's extension determines its format.
// Requires: at least one file, and exactly one if there are poses.
// Throws: std::runtime_error with one line: the file, its line or byte, and what was expected and found.
MeshPairs read_bodies(const std::vector<std::filesystem::path>& files, const std::filesystem::path& poses = {});

// Reads only a mesh's triangles, and finds no pairs.
MeshPairs read_triangles(const std::filesystem::path& file, Coordinates coordinates = Coordinates::finite);

}  // namespace graze::strata
