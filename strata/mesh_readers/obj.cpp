// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: reads vertices and faces. Lines, points, normals, groups and materials are counted and skipped.
#include <algorithm>
#include <limits>

#include "core/text.h"
#include "strata/mesh_readers/lines.h"

namespace graze::strata {
namespace {

struct Skipped {
  std::string_view keyword;
  const char* what;
};
constexpr Skipped kSkipped[] = {{"vt", "texture coordinates"},
                                {"vn", "normals"},
                                {"l", "lines"},
                                {"p", "points"},
                                {"g", "groups"},
                                {"o", "objects"},
                                {"s", "smoothing groups"},
                                {"usemtl", "materials"},
                                {"mtllib", "material libraries"}};

// The largest vertex index used by a face so far (the vertex may be defined later), and that face's line.
struct Largest {
  std::uint64_t vertex = 0;
  std::size_t line = 0;
};

// A nonzero whole number: 1 is the file's first vertex, and -1 is the last one defined so far.
std::optional<std::int64_t> parse_reference(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const std::optional<std::uint64_t> value = parse_whole(text);
  if (!value || *value == 0 || *value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return negative ? -static_cast<std::int64_t>(*value) : static_cast<std::int64_t>(*value);
}

// "v", "v/t", "v//n" or "v/t/n"; only v is used.
std::optional<std::int64_t> parse_corner(std::string_view word) {
  const std::size_t slash = word.find('/');
  const std::optional<std::int64_t> vertex = parse_reference(word.substr(0, slash));
  if (slash == word.npos) return vertex;
  const std::string_view rest = word.substr(slash + 1);
  const std::size_t second = rest.find('/');
  const std::string_view texture = rest.substr(0, second);
  const bool texture_is_sound = parse_reference(texture) || (texture.empty() && second != rest.npos);
  const bool normal_is_sound = second == rest.npos || parse_reference(rest.substr(second + 1));
  return texture_is_sound && normal_is_sound ? vertex : std::nullopt;
}

void add_vertex(Soup& soup, const Lines& lines) {
  const std::size_t count = lines.words().size() - 1;
  const auto coordinate = [&](std::size_t i) { return lines.coordinate(i, soup.rounding); };
  soup.add_vertex({coordinate(1), coordinate(2), coordinate(3)});
  for (std::size_t i = 4; i <= count; ++i) lines.number(i, "a number or the end of the line");
  if (count == 5 || count > 7)
    lines.fail("three coordinates, optionally with a weight, a colour or both", std::to_string(count) + " numbers");
  if (count == 4 || count == 7) ++soup.skipped["weights"];
  if (count >= 6) ++soup.skipped["vertex colours"];
  if (soup.vertices.size() > std::numeric_limits<std::uint32_t>::max()) lines.fail("fewer than 2^32 vertices", "more");
}

void add_face(Soup& soup, const Lines& lines, std::vector<std::uint32_t>& face, Largest& largest) {
  const auto& words = lines.words();
  if (words.size() < 4) lines.fail("a face of at least three vertices", std::to_string(words.size() - 1));
  face.clear();
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::optional<std::int64_t> corner = parse_corner(words[i]);
    const auto defined = static_cast<std::int64_t>(soup.vertices.size());
    if (!corner || *corner < -defined)
      lines.fail_at(
          i, "a vertex such as 1, 1/2, 1//3 or 1/2/3, or one of the last " + std::to_string(defined) + ", such as -1");
    const auto vertex = static_cast<std::uint64_t>(*corner < 0 ? defined + *corner : *corner - 1);
    if (vertex >= largest.vertex || largest.line == 0) largest = {vertex, lines.line()};
    face.push_back(static_cast<std::uint32_t>(vertex));
  }
  add_face(soup, face);
}

}  // namespace

Soup read_obj(const MeshBytes& file) {
  Lines lines(file, '#', Continuation::backslash);
  Soup soup;
  Largest largest;
  std::vector<std::uint32_t> face;
  while (lines.next()) {
    const std::string_view keyword = lines.words()[0];
    if (keyword == "v") {
      add_vertex(soup, lines);
    } else if (keyword == "f") {
      add_face(soup, lines, face, largest);
    } else {
      const auto known = std::find_if(std::begin(kSkipped), std::end(kSkipped),
                                      [&](const Skipped& row) { return row.keyword == keyword; });
      if (known == std::end(kSkipped)) lines.fail_at(0, "v, f, vt, vn, l, p, g, o, s, usemtl or mtllib");
      ++soup.skipped[known->what];
    }
  }
  if (largest.line != 0 && largest.vertex >= soup.vertices.size())
    fail(at_line(file, largest.line),
         "faces that use only the file's " + std::to_string(soup.vertices.size()) + " vertices",
         "vertex " + std::to_string(largest.vertex + 1));
  return soup;
}

}  // namespace graze::strata
