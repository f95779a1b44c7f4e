// SPDX-License-Identifier: Apache-2.0
// Pairs from real input: the triangles of a mesh, or of two, whose closed bounding boxes overlap.
// Boxes: CGAL's hybrid of streaming and segment trees (Zomorodian and Edelsbrunner 2002).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/pair.h"

namespace graze::strata {

struct MeshPairs {
  std::vector<std::array<Vec3<float>, 3>> triangles;  // of the first file, then of the other, in file order
  std::vector<std::pair<std::uint32_t, std::uint32_t>> candidates;  // indices into triangles, sorted, first < second
  std::uint64_t content_hash = 0;  // FNV-1a of the bytes of the file, then of the other
  std::vector<std::string> notes;  // one line a file of which something was not used, such as its normals

  std::size_t size() const { return candidates.size(); }

  // Requires: index < size().
  Pair pair(std::size_t index) const;
};

// The candidate pairs of a mesh against itself, or against the other. Faces of more than three vertices are cut
// into a fan from their first vertex. Coordinates are rounded once to float32, and
// triangles that are degenerate then stay in; the boxes are those of the rounded triangles, so no pair that
// touches is missed. Files: OFF, OBJ, STL and PLY, told apart by their extension.
// Throws: std::runtime_error of one line that names file, line or byte, what was expected and what was found.
MeshPairs read_mesh_pairs(const std::filesystem::path& file,
                          const std::optional<std::filesystem::path>& other = std::nullopt);

// The same of bodies: of one its own pairs, of several the pairs between them. Poses, a CSV file with a row of twelve
// numbers for each, the three rows of a matrix (R | t), make a body of each pose of the one mesh.
// Requires: at least one file, and one alone where there are poses.
MeshPairs read_bodies(const std::vector<std::filesystem::path>& files, const std::filesystem::path& poses = {});

// The triangles of a mesh alone; and with the candidate pairs of the mesh against itself, which may be none.
MeshPairs read_triangles(const std::filesystem::path& file);
MeshPairs read_self_pairs(const std::filesystem::path& file);

}  // namespace graze::strata
