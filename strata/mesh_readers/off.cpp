// SPDX-License-Identifier: Apache-2.0
// Reads Geomview's OFF in text form, and its variants with normals (N), colours (C) and texture coordinates (ST).
#include <limits>

#include "core/text.h"
#include "strata/mesh_readers/lines.h"

namespace graze::strata {
namespace {

struct Header {
  bool normals = false, colours = false, texture = false;
  std::uint64_t vertices = 0, faces = 0;
};

// Parses a keyword such as "CNOFF".   Returns: whether the word is a keyword.
bool take_keyword(std::string_view word, Header& header) {
  const auto take = [&word](std::string_view prefix) {
    const bool found = word.starts_with(prefix);
    if (found) word.remove_prefix(prefix.size());
    return found;
  };
  header.texture = take("ST");
  header.colours = take("C");
  header.normals = take("N");
  return word == "OFF";
}

// Reads the keyword, which may be missing, and the counts, which may be on the keyword's line.
Header take_header(Lines& lines) {
  Header header;
  lines.expect_next("OFF");
  std::size_t at = 0;
  if (!parse_whole(lines.words()[0])) {
    if (!take_keyword(lines.words()[0], header)) lines.fail_at(0, "OFF, or COFF, NOFF, CNOFF, STOFF");
    if (lines.words().size() == 2 && lines.words()[1] == "BINARY") lines.fail_at(1, "OFF in text");
    at = 1;
    if (lines.words().size() == 1) {
      lines.expect_next("the numbers of vertices, faces and edges");
      at = 0;
    }
  }
  header.vertices = lines.whole(at, "the number of vertices");
  header.faces = lines.whole(at + 1, "the number of faces");
  if (lines.words().size() > at + 2) lines.whole(at + 2, "the number of edges");
  if (lines.words().size() > at + 3) lines.fail_at(at + 3, "the end of the line after the number of edges");
  // A vertex takes at least six bytes ("0 0 0" and the line's end), and a face at least two.
  const std::size_t bytes = lines.bytes_left();
  if (header.vertices > (bytes + 1) / 6 || header.faces > (bytes + 1) / 2)
    lines.fail("at most " + std::to_string((bytes + 1) / 6) + " vertices and " + std::to_string((bytes + 1) / 2) +
                   " faces in the " + std::to_string(bytes) + " bytes that follow",
               std::to_string(header.vertices) + " and " + std::to_string(header.faces));
  if (header.vertices > std::numeric_limits<std::uint32_t>::max())
    lines.fail("fewer than 2^32 vertices", std::to_string(header.vertices));
  return header;
}

// Checks and counts the numbers after a vertex's coordinates.
void skip_attributes(const Lines& lines, const Header& header, Soup& soup) {
  const std::size_t count = lines.words().size(), more = count - 3;
  for (std::size_t i = 3; i < count; ++i) lines.number(i, "a number or the end of the line");
  const std::size_t others = 3u * header.normals + 2u * header.texture;
  const std::size_t colour = more - others;
  // Plain OFF files contain colours too.
  if (more < others || (colour != 0 && colour != 3 && colour != 4) || (header.colours && colour == 0))
    lines.fail("three coordinates" +
                   std::string(others + header.colours > 0 ? " and the values that the header announces" : ""),
               std::to_string(count) + " numbers");
  if (header.normals) ++soup.skipped["normals"];
  if (header.texture) ++soup.skipped["texture coordinates"];
  if (colour > 0) ++soup.skipped["vertex colours"];
}

}  // namespace

Soup read_off(const MeshBytes& file) {
  Lines lines(file, '#');
  const Header header = take_header(lines);
  Soup soup;
  soup.vertices.reserve(header.vertices);
  for (std::uint64_t i = 0; i < header.vertices; ++i) {
    lines.expect_next(std::to_string(header.vertices) + " vertices");
    const auto coordinate = [&](std::size_t c) { return lines.coordinate(c, soup.rounding); };
    soup.add_vertex({coordinate(0), coordinate(1), coordinate(2)});
    if (lines.words().size() > 3 || header.normals || header.texture || header.colours)
      skip_attributes(lines, header, soup);
  }
  std::vector<std::uint32_t> face;
  for (std::uint64_t i = 0; i < header.faces; ++i) {
    lines.expect_next(std::to_string(header.faces) + " faces");
    const std::uint64_t count = lines.whole(0, "the number of a face's vertices");
    const std::size_t words = lines.words().size();
    if (count > words - 1)
      lines.fail(std::to_string(count) + " vertices for a face", std::to_string(words - 1) + " numbers");
    face.clear();
    for (std::size_t j = 1; j <= count; ++j) face.push_back(lines.vertex(j, soup.vertices.size()));
    add_face(soup, face);
    const std::size_t colour = words - 1 - count;
    for (std::size_t j = count + 1; j < words; ++j) lines.number(j, "a number or the end of the line");
    if (colour == 2 || colour > 4)
      lines.fail(std::to_string(count) + " vertices for a face and at most one colour",
                 std::to_string(words - 1) + " numbers");
    if (colour > 0) ++soup.skipped["face colours"];
  }
  if (lines.next())
    lines.fail_at(0, "the end of the file after " + std::to_string(header.vertices) + " vertices and " +
                         std::to_string(header.faces) + " faces");
  return soup;
}

}  // namespace graze::strata
