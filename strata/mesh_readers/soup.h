// SPDX-License-Identifier: Apache-2.0
// The mesh readers, one for each format, and their result. The readers are strict: text that does not parse completely,
// or numbers that contradict each other, cause an error that names the place. Content that pairs do not need is counted
// and skipped. Nothing else is skipped.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"

namespace graze::strata {

// How many coordinates float32 cannot hold, and how far rounding moved them. `beyond` counts coordinates that no
// program would print for a float32, such as 1000000.01, but not 0.1, which programs print for a float32.
struct Rounding {
  std::uint64_t coordinates = 0, rounded = 0, beyond = 0;
  double most = 0;  // no coordinate moved by more than this

  // written: the double nearest to the number in the file.   is_it: whether `written` equals that number.   slack: a
  // bound on their difference.
  void add(double written, float stored, double slack = 0, bool is_it = true) {
    ++coordinates;
    if (!std::isfinite(written) || (is_it && written == static_cast<double>(stored))) return;
    ++rounded;
    most = std::max(most, std::abs(written - static_cast<double>(stored)) + slack);
  }
  Rounding& operator+=(const Rounding& other) {
    coordinates += other.coordinates;
    rounded += other.rounded;
    beyond += other.beyond;
    most = std::max(most, other.most);
    return *this;
  }
};

// "FILE: float32 rounded 5 of 18 coordinates, by at most 0.00012" (rounded up). Empty if float32 holds all coordinates.
std::vector<std::string> rounding_note(const std::string& file, const Rounding& rounding);

// The same for callers that use the doubles: "FILE: decided in doubles, because 6 of 18 coordinates have more digits
// than float32 holds". Empty if float32 holds all digits.
std::vector<std::string> doubles_note(const std::string& file, const Rounding& rounding);

// The float32 and the double nearest to a number in a file.
struct Coordinate {
  float stored;
  double written;
};

struct Soup {
  std::vector<Vec3<float>> vertices;                    // finite, unless MeshBytes::coordinates is `any`
  std::vector<Vec3<double>> in_doubles;                 // the same vertices before rounding to float32
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of existing vertices, in file order
  std::map<std::string, std::uint64_t> skipped;         // how many items were skipped, by kind: "normals"
  std::vector<std::array<std::size_t, 2>> fans;  // triangles of each face with more than three vertices: begin, end
  Rounding rounding;                             // how float32 rounded the vertices

  void add_vertex(const Coordinate (&v)[3]) {
    vertices.push_back({v[0].stored, v[1].stored, v[2].stored});
    in_doubles.push_back({v[0].written, v[1].written, v[2].written});
  }
};

// Whether a vertex that is not finite causes an error (finite) or is read unchanged (any).
enum class Coordinates { finite, any };

// The bytes of a file, and its name for error messages.
struct MeshBytes {
  std::string name;
  std::string_view bytes;
  Coordinates coordinates = Coordinates::finite;

  bool may_be(float coordinate) const { return coordinates == Coordinates::any || std::isfinite(coordinate); }
};

// Parses the bytes of a mesh file. Decimals become the nearest float32 and the nearest double, each rounded once.
// Throws: std::runtime_error with one line: the file, its line or byte, and what was expected and found.
#define GRAZE_MESH_FORMAT(extension, name) Soup read_##extension(const MeshBytes& file);
#include "strata/mesh_readers/formats.inc"
#undef GRAZE_MESH_FORMAT

// Cuts a face into a fan from its first vertex. A face with fewer than three vertices is counted as skipped.
void add_face(Soup& soup, std::span<const std::uint32_t> face);

// "FILE:LINE", or "FILE" with a byte position.
std::string at_line(const MeshBytes& file, std::size_t line);
std::string at_byte(const MeshBytes& file, std::size_t byte);

[[noreturn]] void fail(const std::string& where, const std::string& expected, const std::string& found);

}  // namespace graze::strata
