// SPDX-License-Identifier: Apache-2.0
// Pairs from real input: files are read by CGAL, rounded to float32, and paired by their closed boxes.
#include "strata/mesh.h"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include "core/fnv1a.h"

namespace graze::strata {
namespace {

using Triangle = std::array<Vec3<float>, 3>;
using MeshPoint = CGAL::Simple_cartesian<double>::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<float, 3, std::uint32_t>;  // info: index of the triangle

// So that a soup in which everything overlaps everything is an error, not all of the memory.
constexpr std::size_t kMostCandidates = std::size_t{1} << 28;  // 2 GiB of indices

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& expected, const std::string& found) {
  throw std::runtime_error(file.string() + ": expected " + expected + ", found " + found);
}

// Sends what a stream is told nowhere for as long as it lives.
class Silence {
 public:
  explicit Silence(std::ostream& stream) : stream_(stream), buffer_(stream.rdbuf(nullptr)) {}
  ~Silence() { stream_.rdbuf(buffer_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  std::ostream& stream_;
  std::streambuf* buffer_;
};

// The hash, continued over the bytes of the file.
std::uint64_t hash_file(const std::filesystem::path& file, std::uint64_t hash) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file)) fail(file, "a mesh file", "none that can be opened");
  char block[65536];
  do {
    in.read(block, sizeof block);
    hash = fnv1a({block, static_cast<std::size_t>(in.gcount())}, hash);
  } while (in);
  return hash;
}

// CGAL's PLY reader (5.5) crashes on a property of no element and on coordinates of an integer type, and takes
// missing ones for zero.   Returns: whether the header has none of these.
bool ply_header_is_sound(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line, element;
  int coordinates_found = 0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string keyword, type, name;
    words >> keyword >> type >> name;
    if (keyword == "end_header") return coordinates_found == 3;
    if (keyword == "element") element = type;
    if (keyword != "property") continue;
    if (element.empty()) return false;
    const bool of_vertex = element == "vertex" || element == "vertices";
    if (!of_vertex || (name != "x" && name != "y" && name != "z")) continue;
    if (type != "float" && type != "float32" && type != "double" && type != "float64") return false;
    ++coordinates_found;
  }
  return false;
}

// Appends the triangles of the file.
void read_triangles(const std::filesystem::path& file, std::vector<Triangle>& triangles) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension != ".off" && extension != ".obj" && extension != ".stl" && extension != ".ply") {
    fail(file, "a file of extension .off, .obj, .stl or .ply", extension.empty() ? "no extension" : extension);
  }
  const std::string format(extension.begin() + 1, extension.end());

  std::vector<MeshPoint> points;
  std::vector<std::vector<std::size_t>> faces;
  bool parsed = false;
  try {
    const Silence silent_out(std::cout), silent_error(std::cerr);
    parsed =
        (format != "ply" || ply_header_is_sound(file)) && CGAL::IO::read_polygon_soup(file.string(), points, faces);
  } catch (const std::exception&) {  // a header that promises more than memory holds, or a CGAL precondition
  }
  if (!parsed) fail(file, "a mesh in the " + format + " format", "text or bytes that do not parse as one");

  std::vector<Vec3<float>> vertices;
  vertices.reserve(points.size());
  for (const MeshPoint& point : points) {
    const Vec3<float> v{static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())};
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
      fail(file, "coordinates that are finite in float32", "vertex " + std::to_string(vertices.size()) + " without");
    }
    vertices.push_back(v);
  }

  const std::size_t before = triangles.size();
  for (const std::vector<std::size_t>& face : faces) {
    for (const std::size_t index : face) {
      if (index >= vertices.size()) {
        fail(file, "faces of its " + std::to_string(vertices.size()) + " vertices", "one of another vertex");
      }
    }
    for (std::size_t i = 2; i < face.size(); ++i) {
      triangles.push_back({vertices[face[0]], vertices[face[i - 1]], vertices[face[i]]});
    }
  }
  if (triangles.size() == before) fail(file, "at least one triangle", "none");
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max()) fail(file, "fewer than 2^32 triangles", "more");
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
  result.content_hash = hash_file(file, fnv1a(""));
  if (other) result.content_hash = hash_file(*other, result.content_hash);
  read_triangles(file, result.triangles);
  const std::size_t first_count = result.triangles.size();
  if (other) read_triangles(*other, result.triangles);

  const auto add = [&](const Box& p, const Box& q) {
    if (result.candidates.size() == kMostCandidates) {
      fail(file, "at most 2^28 pairs of triangles whose boxes overlap", "more");
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
  if (result.candidates.empty()) fail(file, "at least one pair of triangles whose boxes overlap", "none");
  std::sort(result.candidates.begin(), result.candidates.end());
  return result;
}

}  // namespace graze::strata
