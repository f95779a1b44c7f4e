// SPDX-License-Identifier: Apache-2.0
// Pairs from real input: files are read to float32 triangles, which are paired by their closed boxes.
#include "strata/mesh.h"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <limits>
#include <string>

#include "core/fnv1a.h"
#include "strata/mesh_readers/soup.h"

namespace graze::strata {
namespace {

using Triangle = std::array<Vec3<float>, 3>;
using Box = CGAL::Box_intersection_d::Box_with_info_d<float, 3, std::uint32_t>;  // info: index of the triangle

// So that a soup in which everything overlaps everything is an error, not all of the memory.
constexpr std::size_t kMostCandidates = std::size_t{1} << 28;  // 2 GiB of indices

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file)) fail(file.string(), "a mesh file", "none that can be opened");
  std::string bytes(std::filesystem::file_size(file), '\0');
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    fail(file.string(), "its " + std::to_string(bytes.size()) + " bytes", "an error of reading");
  return bytes;
}

Soup read_soup(const std::filesystem::path& file, std::string_view bytes) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const MeshBytes mesh{file.string(), bytes};
  if (extension == ".off") return read_off(mesh);
  if (extension == ".obj") return read_obj(mesh);
  if (extension == ".stl") return read_stl(mesh);
  if (extension == ".ply") return read_ply(mesh);
  fail(mesh.name, "a file of extension .off, .obj, .stl or .ply", extension.empty() ? "no extension" : extension);
}

// Adds the file's triangles, and its bytes to the hash.
void add_mesh(MeshPairs& pairs, const std::filesystem::path& file) {
  const std::string bytes = read_bytes(file);
  pairs.content_hash = fnv1a(bytes, pairs.content_hash);
  const Soup soup = read_soup(file, bytes);
  if (soup.triangles.empty()) fail(file.string(), "at least one triangle", "none");
  for (const auto& [i, j, k] : soup.triangles)
    pairs.triangles.push_back({soup.vertices[i], soup.vertices[j], soup.vertices[k]});
  if (pairs.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    fail(file.string(), "fewer than 2^32 triangles", "more");
  std::string skipped;
  for (const auto& [what, count] : soup.skipped)
    skipped += (skipped.empty() ? "" : ", ") + std::to_string(count) + ' ' + what;
  if (!skipped.empty())
    pairs.notes.push_back(file.string() + ": " + std::to_string(soup.triangles.size()) +
                          " triangles; not used: " + skipped);
}

std::vector<Box> boxes_of(const std::vector<Triangle>& triangles, std::size_t begin, std::size_t end) {
  std::vector<Box> boxes;
  boxes.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax(
          {component(triangles[i][0], axis), component(triangles[i][1], axis), component(triangles[i][2], axis)});
      low[axis] = least;
      high[axis] = most;
    }
    boxes.emplace_back(low, high, static_cast<std::uint32_t>(i));
  }
  return boxes;
}

}  // namespace

Pair MeshPairs::pair(std::size_t index) const {
  const Triangle& a = triangles[candidates[index].first];
  const Triangle& b = triangles[candidates[index].second];
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

MeshPairs read_mesh_pairs(const std::filesystem::path& file, const std::optional<std::filesystem::path>& other) {
  MeshPairs result;
  result.content_hash = fnv1a("");
  add_mesh(result, file);
  const std::size_t first_count = result.triangles.size();
  if (other) add_mesh(result, *other);

  const auto add = [&](const Box& p, const Box& q) {
    if (result.candidates.size() == kMostCandidates) {
      fail(file.string(), "at most 2^28 pairs of triangles whose boxes overlap", "more");
    }
    result.candidates.push_back(std::minmax({p.info(), q.info()}));
  };
  std::vector<Box> boxes = boxes_of(result.triangles, 0, first_count);
  if (other) {
    std::vector<Box> other_boxes = boxes_of(result.triangles, first_count, result.triangles.size());
    CGAL::box_intersection_d(boxes.begin(), boxes.end(), other_boxes.begin(), other_boxes.end(), add);
  } else {
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), add);
  }
  if (result.candidates.empty()) fail(file.string(), "at least one pair of triangles whose boxes overlap", "none");
  std::sort(result.candidates.begin(), result.candidates.end());
  return result;
}

}  // namespace graze::strata
