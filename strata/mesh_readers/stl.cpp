// SPDX-License-Identifier: Apache-2.0
// Reads STL, as text or binary. A file is binary if its size matches the facet count of a binary header, even if the
// header begins with "solid", which many programs write.
#include <bit>
#include <cstring>

#include "core/text.h"
#include "strata/mesh_readers/lines.h"

namespace graze::strata {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes; the header's last four bytes are the number of facets

std::uint64_t count_of_binary(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

void add_triangle(Soup& soup) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size()) - 3;
  soup.triangles.push_back({first, first + 1, first + 2});
}

Soup read_binary(const MeshBytes& file) {
  const std::uint64_t count = count_of_binary(file.bytes);
  Soup soup;
  soup.vertices.reserve(3 * count);
  soup.triangles.reserve(count);
  for (std::size_t at = kHeader; at < file.bytes.size(); at += kFacet) {
    Vec3<float> v[3];
    std::memcpy(v, file.bytes.data() + at + 12, sizeof v);
    for (const Vec3<float>& vertex : v) {
      soup.add_vertex({{vertex.x, double{vertex.x}}, {vertex.y, double{vertex.y}}, {vertex.z, double{vertex.z}}});
      if (!file.may_be(vertex.x) || !file.may_be(vertex.y) || !file.may_be(vertex.z))
        fail(at_byte(file, at), "a facet with finite coordinates", "one without");
    }
    add_triangle(soup);
    soup.rounding.coordinates += 9;
    if (file.bytes[at + 48] != 0 || file.bytes[at + 49] != 0) ++soup.skipped["facet attributes"];
  }
  if (count > 0) soup.skipped["normals"] = count;
  return soup;
}

// Throws: an error unless the line is these words followed by `more` numbers.
void expect_words(Lines& lines, const std::vector<std::string_view>& words, std::size_t more = 0) {
  std::string expected;
  for (const std::string_view word : words) expected.append(expected.empty() ? "" : " ").append(word);
  if (more > 0) expected += " and three numbers";
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i >= lines.words().size() || lines.words()[i] != words[i]) lines.fail_at(i, expected);
  }
  if (lines.words().size() > words.size() + more)
    lines.fail_at(words.size() + more, "the end of the line after " + expected);
}

void take_facet(Lines& lines, Soup& soup) {
  expect_words(lines, {"facet", "normal"}, 3);
  for (std::size_t i = 2; i < 5; ++i) lines.number(i, "a normal of three numbers");
  ++soup.skipped["normals"];
  lines.expect_next("outer loop");
  expect_words(lines, {"outer", "loop"});
  for (int corner = 0; corner < 3; ++corner) {
    lines.expect_next("a vertex");
    expect_words(lines, {"vertex"}, 3);
    const auto coordinate = [&](std::size_t i) { return lines.coordinate(i, soup.rounding); };
    soup.add_vertex({coordinate(1), coordinate(2), coordinate(3)});
  }
  lines.expect_next("endloop");
  expect_words(lines, {"endloop"});
  lines.expect_next("endfacet");
  expect_words(lines, {"endfacet"});
  add_triangle(soup);
}

// Reads all solids of a text file: each is "solid NAME", facets, "endsolid NAME".
Soup read_text(const MeshBytes& file) {
  Lines lines(file, '\0');
  Soup soup;
  bool inside = false;
  while (lines.next()) {
    const std::string_view word = lines.words()[0];
    if (!inside) {
      if (word != "solid")
        lines.fail_at(
            0, "solid, or a binary file with a header of 84 bytes and 50 bytes for each facet that the header counts");
      inside = true;
    } else if (word == "endsolid") {
      inside = false;
    } else if (word == "facet") {
      take_facet(lines, soup);
    } else {
      lines.fail_at(0, "facet or endsolid");
    }
  }
  if (inside) lines.expect_next("endsolid");
  return soup;
}

}  // namespace

Soup read_stl(const MeshBytes& file) {
  const std::size_t size = file.bytes.size();
  const std::uint64_t count = count_of_binary(file.bytes);
  if (size >= kHeader && size == kHeader + kFacet * count) return read_binary(file);
  // A text file has no zero byte.
  if (size >= kHeader && file.bytes.find('\0') != file.bytes.npos)
    fail(at_byte(file, 80),
         std::to_string(kHeader + kFacet * count) + " bytes for the " + std::to_string(count) +
             " facets that the header counts",
         std::to_string(size) + " bytes");
  return read_text(file);
}

}  // namespace graze::strata
