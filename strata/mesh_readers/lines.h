// SPDX-License-Identifier: Apache-2.0
// Reads a text mesh file line by line and splits each line into words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "strata/mesh_readers/soup.h"

namespace graze::strata {

// Whether the number in `text` is exactly `value`.
// Requires: text is a number, and `value` is the finite double nearest to it.   Exact: always.
bool is_exactly(const std::string& text, double value);

// Whether a backslash at the end of a line joins it to the next line.
enum class Continuation { none, backslash };

class Lines {
 public:
  // comment: the character that starts a comment, up to the end of the line; '\0' for none. A byte order mark is
  // skipped.
  Lines(const MeshBytes& file, char comment, Continuation continuation = Continuation::none);

  // Moves to the next line that has a word.   Returns: false if no line with a word is left.
  bool next();
  // Like next.   Throws: an error that names `expected` if no line is left.
  void expect_next(const std::string& expected);

  const std::vector<std::string_view>& words() const { return words_; }
  std::size_t line() const { return line_; }
  std::size_t next_byte() const { return byte_; }  // the first byte after the line
  std::size_t bytes_left() const { return file_.bytes.size() - byte_; }

  // Parses word i.   Throws: an error if the line has no word i, or if the word does not parse.
  Coordinate coordinate(std::size_t i, Rounding& rounding) const;
  std::uint64_t whole(std::size_t i, const std::string& expected) const;
  std::uint32_t vertex(std::size_t i, std::size_t vertices) const;
  double number(std::size_t i, const std::string& expected) const;  // NaN beyond the range of double

  // Throws: an error that names this line. fail_at reports word i as found, or the end of the line if there is none.
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const;
  [[noreturn]] void fail_at(std::size_t i, const std::string& expected) const;

 private:
  bool read_line();

  MeshBytes file_;
  char comment_;
  Continuation continuation_;
  std::size_t byte_ = 0, line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace graze::strata
