// SPDX-License-Identifier: Apache-2.0
// Reads PLY, as text or as binary in either byte order. Uses only the vertices' coordinates and the faces' vertices.
#include <bit>
#include <cstring>
#include <limits>
#include <optional>

#include "core/text.h"
#include "strata/mesh_readers/lines.h"

namespace graze::strata {
namespace {

struct Type {
  std::string_view name, other_name;
  std::size_t size;
  bool is_float, is_signed;
};
constexpr Type kTypes[] = {{"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
                           {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
                           {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
                           {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* count_type = nullptr;  // null if the property is not a list
};

bool is_coordinate(const Property& p) { return p.name == "x" || p.name == "y" || p.name == "z"; }
bool is_corners(const Property& p) { return p.name == "vertex_indices" || p.name == "vertex_index"; }

enum class ElementKind { vertices, faces, other };

struct Element {
  std::string name;
  std::uint64_t count = 0;
  ElementKind kind = ElementKind::other;
  std::vector<Property> properties;

  // The index of the property, or the number of properties if none has that name.
  std::size_t place(std::string_view property) const {
    std::size_t i = 0;
    while (i < properties.size() && properties[i].name != property) ++i;
    return i;
  }
};

struct Header {
  enum class Format { text, little, big } format = Format::text;
  std::vector<Element> elements;
};

const Type& take_type(const Lines& lines, std::size_t i, bool integer) {
  for (const Type& type : kTypes) {
    if (i < lines.words().size() && (lines.words()[i] == type.name || lines.words()[i] == type.other_name) &&
        !(integer && type.is_float))
      return type;
  }
  lines.fail_at(i, integer ? "an integer type" : "a type");
}

void take_property(const Lines& lines, Header& header) {
  if (header.elements.empty()) lines.fail("an element before its properties", "a property");
  const auto& words = lines.words();
  const bool is_list = words.size() > 1 && words[1] == "list";
  Property property;
  if (is_list) property.count_type = &take_type(lines, 2, true);
  property.type = &take_type(lines, is_list ? 3 : 1, false);
  const std::size_t name = is_list ? 4 : 2;
  if (words.size() != name + 1) lines.fail_at(std::min(name, words.size()), "a property's type and its name");
  property.name = words[name];
  Element& element = header.elements.back();
  const bool corners = is_corners(property);
  for (const Property& other : element.properties) {
    if (other.name == property.name || (corners && is_corners(other)))
      lines.fail("every property once", "a second " + shown(property.name));
  }
  if (element.kind == ElementKind::vertices && is_coordinate(property) && (is_list || !property.type->is_float))
    lines.fail_at(1, "float or double as the type of a coordinate");
  if (element.kind == ElementKind::faces && corners && (!is_list || property.type->is_float))
    lines.fail_at(1, "a list of integers as a face's vertices");
  element.properties.push_back(property);
}

void take_element(const Lines& lines, Header& header) {
  if (lines.words().size() != 3)
    lines.fail("an element's name and count", std::to_string(lines.words().size() - 1) + " words");
  Element element{std::string(lines.words()[1]), lines.whole(2, "a count of elements"), ElementKind::other, {}};
  if (element.name == "vertex" || element.name == "vertices") element.kind = ElementKind::vertices;
  if (element.name == "face" || element.name == "faces") element.kind = ElementKind::faces;
  if (element.name == "tristrips") lines.fail_at(1, "faces, not strips of triangles");
  for (const Element& other : header.elements) {
    if (other.name == element.name || (other.kind == element.kind && other.kind != ElementKind::other))
      lines.fail("every element once", "a second " + shown(element.name));
  }
  header.elements.push_back(std::move(element));
}

void check(const Lines& lines, const Header& header) {
  for (const Element& element : header.elements) {
    const auto expect = [&](bool holds, const char* what) {
      if (!holds) lines.fail(std::string(what) + " in the element " + element.name, "none");
    };
    expect(!element.properties.empty() || element.count == 0, "a property");
    if (element.kind == ElementKind::vertices) {
      for (const char* name : {"x", "y", "z"})
        expect(element.place(name) < element.properties.size(), "coordinates x, y and z");
      if (element.count > std::numeric_limits<std::uint32_t>::max())
        lines.fail("fewer than 2^32 vertices", std::to_string(element.count));
    }
    if (element.kind == ElementKind::faces)
      expect(std::min(element.place("vertex_indices"), element.place("vertex_index")) < element.properties.size(),
             "a list vertex_indices");
  }
}

Header take_header(Lines& lines) {
  Header header;
  lines.expect_next("ply");
  if (lines.words().size() != 1 || lines.words()[0] != "ply") lines.fail_at(0, "ply");
  lines.expect_next("format");
  const auto& words = lines.words();
  if (words[0] != "format") lines.fail_at(0, "format");
  using Format = Header::Format;
  std::optional<Format> format;
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") format = Format::text;
    if (words[1] == "binary_little_endian") format = Format::little;
    if (words[1] == "binary_big_endian") format = Format::big;
  }
  if (!format) lines.fail_at(1, "ascii, binary_little_endian or binary_big_endian, and 1.0");
  header.format = *format;
  for (;;) {
    lines.expect_next("end_header");
    if (words[0] == "end_header") break;
    if (words[0] == "element") {
      take_element(lines, header);
    } else if (words[0] == "property") {
      take_property(lines, header);
    } else if (words[0] != "comment" && words[0] != "obj_info") {
      lines.fail_at(0, "element, property, comment, obj_info or end_header");
    }
  }
  check(lines, header);
  return header;
}

// Reads the numbers of a file's body in order, including the count before each list.
class Body {
 public:
  Body(const MeshBytes& file, Lines& lines, Header::Format format)
      : file_(file), lines_(lines), format_(format), byte_(lines.next_byte()) {}

  // Throws: an error if the rows cannot fit in the rest of the file.
  void expect_room(const Element& element) const {
    std::uint64_t row = 0;
    for (const Property& p : element.properties)
      row += is_text() ? 2 : p.count_type ? p.count_type->size : p.type->size;
    const std::uint64_t bytes = is_text() ? lines_.bytes_left() + 1 : file_.bytes.size() - byte_;
    if (row > 0 && element.count > bytes / row)
      fail("at most " + std::to_string(bytes / row) + " elements named " + element.name + " in the " +
               std::to_string(bytes) + " bytes that are left",
           std::to_string(element.count));
  }
  void begin_row(const Element& element) {
    if (!is_text()) return;
    lines_.expect_next(std::to_string(element.count) + " elements named " + element.name);
    word_ = 0;
  }
  void end_row() const {
    if (is_text() && word_ < lines_.words().size()) lines_.fail_at(word_, "the end of the line");
  }
  void end() {
    if (is_text() ? lines_.next() : byte_ < file_.bytes.size())
      fail("the end of the file after its elements",
           is_text() ? shown(lines_.words()[0]) : std::to_string(file_.bytes.size() - byte_) + " bytes more");
  }

  Coordinate coordinate(const Type& type, Rounding& rounding) {
    if (is_text()) return lines_.coordinate(word_++, rounding);
    const double written = type.size == 4 ? static_cast<double>(std::bit_cast<float>(take<std::uint32_t>()))
                                          : std::bit_cast<double>(take<std::uint64_t>());
    const auto value = static_cast<float>(written);
    rounding.add(written, value);
    rounding.beyond += std::isfinite(written) && written != static_cast<double>(value);
    if (!file_.may_be(value)) fail("a coordinate that is finite in float32", "one that is not");
    return {value, written};
  }
  std::uint64_t list_count(const Property& list) {
    const std::uint64_t count = whole(*list.count_type, "the count of a list");
    const std::uint64_t room =
        is_text() ? lines_.words().size() - word_ : (file_.bytes.size() - byte_) / list.type->size;
    if (count > room) fail("at most " + std::to_string(room) + " numbers in " + list.name, std::to_string(count));
    return count;
  }
  std::uint64_t whole(const Type& type, const std::string& expected) {
    if (is_text()) return lines_.whole(word_++, expected);
    const std::uint64_t bits = type.size == 1   ? take<std::uint8_t>()
                               : type.size == 2 ? take<std::uint16_t>()
                                                : take<std::uint32_t>();
    if (type.is_signed && (bits >> (8 * type.size - 1)) != 0) fail(expected, "a negative number");
    return bits;
  }
  void skip(const Type& type) {
    if (is_text()) {
      lines_.number(word_++, "a number");
    } else {
      take_bytes(type.size);
    }
  }

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    strata::fail(is_text() ? at_line(file_, lines_.line()) : at_byte(file_, byte_), expected, found);
  }

 private:
  bool is_text() const { return format_ == Header::Format::text; }

  std::string_view take_bytes(std::size_t size) {
    if (size > file_.bytes.size() - byte_) fail(std::to_string(size) + " bytes", "the end of the file");
    const std::string_view bytes = file_.bytes.substr(byte_, size);
    byte_ += size;
    return bytes;
  }
  template <class Unsigned>
  Unsigned take() {
    const std::string_view bytes = take_bytes(sizeof(Unsigned));
    Unsigned value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::size_t place = format_ == Header::Format::big ? bytes.size() - 1 - i : i;
      value = static_cast<Unsigned>(value | Unsigned{static_cast<unsigned char>(bytes[i])} << (8 * place));
    }
    return value;
  }

  const MeshBytes& file_;
  Lines& lines_;
  Header::Format format_;
  std::size_t byte_;
  std::size_t word_ = 0;
};

void take_vertex(Body& body, const Element& element, Soup& soup) {
  Coordinate vertex[3]{};
  for (const Property& p : element.properties) {
    if (is_coordinate(p)) {
      vertex[p.name[0] - 'x'] = body.coordinate(*p.type, soup.rounding);
      continue;
    }
    for (std::uint64_t n = p.count_type ? body.list_count(p) : 1; n > 0; --n) body.skip(*p.type);
  }
  soup.add_vertex(vertex);
}

void take_face(Body& body, const Element& element, std::uint64_t vertices, Soup& soup,
               std::vector<std::uint32_t>& face) {
  for (const Property& p : element.properties) {
    const bool corners = is_corners(p);
    std::uint64_t n = p.count_type ? body.list_count(p) : 1;
    if (corners) face.clear();
    for (; n > 0; --n) {
      if (!corners) {
        body.skip(*p.type);
        continue;
      }
      const std::string expected = "a vertex below " + std::to_string(vertices);
      const std::uint64_t vertex = body.whole(*p.type, expected);
      if (vertex >= vertices) body.fail(expected, std::to_string(vertex));
      face.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (corners) add_face(soup, face);
  }
}

}  // namespace

Soup read_ply(const MeshBytes& file) {
  Lines lines(file, '\0');
  const Header header = take_header(lines);
  std::uint64_t vertices = 0;
  for (const Element& element : header.elements) {
    if (element.kind == ElementKind::vertices) vertices = element.count;
  }
  Soup soup;
  Body body(file, lines, header.format);
  std::vector<std::uint32_t> face;
  for (const Element& element : header.elements) {
    body.expect_room(element);
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      body.begin_row(element);
      if (element.kind == ElementKind::vertices) take_vertex(body, element, soup);
      if (element.kind == ElementKind::faces) take_face(body, element, vertices, soup, face);
      if (element.kind == ElementKind::other) {
        for (const Property& p : element.properties) {
          for (std::uint64_t n = p.count_type ? body.list_count(p) : 1; n > 0; --n) body.skip(*p.type);
        }
      }
      body.end_row();
    }
    if (element.kind == ElementKind::other && element.count > 0)
      soup.skipped["elements named " + printable(element.name)] = element.count;
    for (const Property& p : element.properties) {
      const bool used = element.kind == ElementKind::vertices ? is_coordinate(p) : is_corners(p);
      if (element.kind != ElementKind::other && !used && element.count > 0)
        soup.skipped["values of " + printable(element.name + '.' + p.name)] = element.count;
    }
  }
  body.end();
  return soup;
}

}  // namespace graze::strata
