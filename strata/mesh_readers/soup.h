// SPDX-License-Identifier: Apache-2.0
// What the readers of mesh files return, one reader a format. They are strict: whatever does not parse in full, and
// every number that does not agree with another, is an error that names the place. What pairs have no use for
// is counted and left out, nothing else is.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"

namespace graze::strata {

struct Soup {
  std::vector<Vec3<float>> vertices;                    // finite
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of vertices that exist, in file order
  std::map<std::string, std::uint64_t> skipped;         // how many, by what they are: "normals"
};

// The bytes of a file, and its name for messages.
struct MeshBytes {
  std::string name;
  std::string_view bytes;
};

// The mesh that the bytes hold; decimals become the nearest float32, rounded once.
// Throws: std::runtime_error of one line that names file, line or byte, what was expected and what was found.
Soup read_off(const MeshBytes& file);
Soup read_obj(const MeshBytes& file);
Soup read_stl(const MeshBytes& file);
Soup read_ply(const MeshBytes& file);

// Cuts a face into a fan from its first vertex; one of fewer than three vertices is counted as skipped.
void add_face(Soup& soup, std::span<const std::uint32_t> face);

// "FILE:LINE", or "FILE" with a byte's place.
std::string at_line(const MeshBytes& file, std::size_t line);
std::string at_byte(const MeshBytes& file, std::size_t byte);

[[noreturn]] void fail(const std::string& where, const std::string& expected, const std::string& found);

}  // namespace graze::strata
