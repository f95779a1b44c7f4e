// SPDX-License-Identifier: Apache-2.0
#include "strata/mesh_readers/lines.h"

#include <cfenv>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "core/text.h"

namespace graze::strata {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

}  // namespace

void fail(const std::string& where, const std::string& expected, const std::string& found) {
  throw std::runtime_error(where + ": expected " + expected + ", found " + found);
}

std::string at_line(const MeshBytes& file, std::size_t line) { return file.name + ':' + std::to_string(line); }
std::string at_byte(const MeshBytes& file, std::size_t byte) { return file.name + ": byte " + std::to_string(byte); }

std::vector<std::string> doubles_note(const std::string& file, const Rounding& rounding) {
  if (rounding.beyond == 0) return {};
  return {printable(file) + ": decided in doubles, because " + std::to_string(rounding.beyond) + " of " +
          std::to_string(rounding.coordinates) + " coordinates have more digits than float32 holds"};
}

std::vector<std::string> rounding_note(const std::string& file, const Rounding& rounding) {
  if (rounding.rounded == 0) return {};
  return {printable(file) + ": float32 rounded " + std::to_string(rounding.rounded) + " of " +
          std::to_string(rounding.coordinates) + " coordinates, by at most " +
          (std::isinf(rounding.most) ? "infinity" : rounded_up(rounding.most, 2))};
}

void add_face(Soup& soup, std::span<const std::uint32_t> face) {
  if (face.size() < 3) ++soup.skipped["faces with fewer than three vertices"];
  const std::size_t begin = soup.triangles.size();
  for (std::size_t i = 2; i < face.size(); ++i) soup.triangles.push_back({face[0], face[i - 1], face[i]});
  if (face.size() > 3) soup.fans.push_back({begin, soup.triangles.size()});
}

bool is_exactly(const std::string& text, double value) {
  const int mode = std::fegetround();
  std::fesetround(FE_DOWNWARD);
  const double below = std::strtod(text.c_str(), nullptr);
  std::fesetround(FE_UPWARD);
  const double above = std::strtod(text.c_str(), nullptr);
  std::fesetround(mode);
  return below == value && above == value;
}

Lines::Lines(const MeshBytes& file, char comment, Continuation continuation)
    : file_(file), comment_(comment), continuation_(continuation) {
  if (file.bytes.starts_with("\xef\xbb\xbf")) byte_ = 3;
}

// Appends the next line's words.   Returns: whether there is a next line.
bool Lines::read_line() {
  if (byte_ == file_.bytes.size()) return false;
  ++line_;
  const std::size_t end = std::min(file_.bytes.find('\n', byte_), file_.bytes.size());
  const std::string_view text = file_.bytes.substr(byte_, end - byte_);
  byte_ = std::min(end + 1, file_.bytes.size());
  for (std::size_t i = 0; i < text.size();) {
    if (is_space(text[i])) {
      ++i;
      continue;
    }
    if (comment_ != '\0' && text[i] == comment_) break;
    const std::size_t begin = i;
    while (i < text.size() && !is_space(text[i]) && (comment_ == '\0' || text[i] != comment_)) ++i;
    words_.push_back(text.substr(begin, i - begin));
  }
  return true;
}

bool Lines::next() {
  words_.clear();
  while (read_line()) {
    if (words_.empty()) continue;
    if (continuation_ == Continuation::none || !words_.back().ends_with('\\')) return true;
    words_.back().remove_suffix(1);
    if (words_.back().empty()) words_.pop_back();
  }
  return !words_.empty();
}

void Lines::expect_next(const std::string& expected) {
  if (!next()) fail(expected, "the end of the file");
}

void Lines::fail(const std::string& expected, const std::string& found) const {
  strata::fail(at_line(file_, line_), expected, found);
}

void Lines::fail_at(std::size_t i, const std::string& expected) const {
  fail(expected, i < words_.size() ? shown(words_[i]) : "the end of the line");
}

namespace {

// Whether `written` is the double nearest to the shortest decimal of `stored`, or to `stored` with nine digits.
bool is_decimal_of(float stored, double written) {
  const auto nearest = [](const char* begin, const char* end) {
    double value = 0;
    std::from_chars(begin, end, value);
    return value;
  };
  char text[32];
  char* const end = text + sizeof text;
  if (nearest(text, std::to_chars(text, end, stored).ptr) == written) return true;
  return nearest(text, std::to_chars(text, end, stored, std::chars_format::general, 9).ptr) == written;
}

}  // namespace

Coordinate Lines::coordinate(std::size_t i, Rounding& rounding) const {
  const std::optional<float> value = i < words_.size() ? parse_float32(words_[i]) : std::nullopt;
  if (!value || !file_.may_be(*value)) fail_at(i, "a coordinate that is finite in float32");
  const std::string word(words_[i]);
  const double written = std::strtod(word.c_str(), nullptr);
  constexpr std::size_t kTold = 15;  // doubles distinguish all decimals with this many digits
  const bool is_zero = word.find_first_not_of("+-0.") == word.npos;
  const bool is_it = is_zero || (word.size() <= kTold && written != 0) || written != static_cast<double>(*value) ||
                     !std::isfinite(written) || is_exactly(word, written);
  rounding.add(written, *value, std::max(std::abs(written) * 0x1p-53, 0x1p-1074), is_it);
  rounding.beyond +=
      std::isfinite(written) && written != static_cast<double>(*value) && !is_decimal_of(*value, written);
  return {*value, written};
}

std::uint64_t Lines::whole(std::size_t i, const std::string& expected) const {
  const std::optional<std::uint64_t> value = i < words_.size() ? parse_whole(words_[i]) : std::nullopt;
  if (!value) fail_at(i, expected);
  return *value;
}

std::uint32_t Lines::vertex(std::size_t i, std::size_t vertices) const {
  const auto expected = [&] {
    return vertices == 0 ? std::string("no face, because there is no vertex")
                         : "a vertex from 0 to " + std::to_string(vertices - 1);
  };
  const std::optional<std::uint64_t> value = i < words_.size() ? parse_whole(words_[i]) : std::nullopt;
  if (!value || *value >= vertices) fail_at(i, expected());
  return static_cast<std::uint32_t>(*value);
}

double Lines::number(std::size_t i, const std::string& expected) const {
  if (i >= words_.size()) fail_at(i, expected);
  std::string_view word = words_[i];
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) fail_at(i, expected);
  return error == std::errc{} ? value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace graze::strata
