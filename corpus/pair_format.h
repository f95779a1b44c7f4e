// SPDX-License-Identifier: Apache-2.0
// The text format of pairs and cases: one pair per line, 18 numbers and optional fields. This is the only code that
// reads and writes the format, which docs/formats.md describes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/any_pair.h"

namespace graze::corpus {

struct Entry {
  Pair pair{};                                                   // for a pair of doubles: the pair that float32 stores
  std::vector<std::pair<std::string, std::string>> fields = {};  // key and value, in the order of the line
  std::size_t line = 0;                                          // its first line; 0 if not read from a file
  std::size_t lines = 1;                                         // number of lines of the entry
  std::vector<std::string> written = {};                         // the 18 numbers as typed, if read from a file
  std::optional<DoublePair> doubles = {};                        // the pair, if its coordinates are doubles
};

// Calls with(pair) for the pair in its own coordinate type.
template <class With>
auto visit(const Entry& entry, const With& with) {
  return entry.doubles ? with(*entry.doubles) : with(entry.pair);
}

AnyPair pair_of(const Entry& entry);

// Makes an entry for a pair that was not read from a file.
Entry entry_of(const AnyPair& pair, std::vector<std::pair<std::string, std::string>> fields);

// Input that is not in the format; what() is one line: "FILE:LINE: expected 18 numbers, found 17".
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Reads a stream one entry at a time, so it can follow a pipe that is still being written. Without a version line, it
// also accepts pasted text: commas, brackets, f suffixes, one vertex per line, C and Python arrays, and an OBJ fragment
// with two faces, or with six vertices and no face.
//
// The pair's coordinates are doubles if it has the field coordinates=f64, if a number is larger than float32's largest,
// or if a hexadecimal number has more digits than float32 holds.
class PairReader {
 public:
  // Requires: `in` outlives the reader. name: the stream's name in messages. taken: the types to accept, f32 or both.
  PairReader(std::istream& in, std::string name, PairTypes taken = PairTypes::f32);

  // Returns: the next entry, or nothing at the end of the stream.
  // Throws: FormatError, also for a pair of doubles if only float32 is accepted. Reading can continue at the line after
  // the bad one.
  std::optional<Entry> next();

 private:
  bool read_line(std::string& text);
  std::string where() const;
  Entry read_obj_fragment(std::string text);

  std::istream& in_;
  std::string name_;
  PairTypes taken_;
  std::size_t line_ = 0;
  bool versioned_ = false;
};

// Opens a file of pairs.   Throws: FormatError if the file is missing, is a folder, or cannot be read.
std::ifstream open_pairs(const std::filesystem::path& file);

// Reads all entries of a file.   Throws: FormatError, including if the file is missing or cannot be read.
std::vector<Entry> read_pairs(const std::filesystem::path& file, PairTypes taken = PairTypes::f32);

// Writes the version line, the first line of every file.
void write_header(std::ostream& out);

// Writes one line: hex floats, then the fields. Reading it back gives the same bits (for a NaN, some NaN) and the same
// fields.
// Requires: keys are distinct and consist of letters, digits and "_-.".
void write_entry(std::ostream& out, const Entry& entry);

// Returns: the shortest hex float, such as "0x1.8p+1", "-0x0p+0", "0x1p-149"; or "inf", "-inf", "nan".
std::string hex_float(double value);

// Returns: the value of the field, or null if the entry has no such key.
const std::string* field(const Entry& entry, std::string_view key);

// Like `field`, but returns an empty string if there is no such key.
std::string text_of(const Entry& entry, std::string_view key);

// Returns STRATUM:SEED:INDEX, or STRATUM@SCENE:SEED:INDEX for a case drawn in a scene; null if a field is missing.
std::optional<std::string> numbers_of(const Entry& entry);

// Returns the result of numbers_of, or else the field `from`: the origin of a minimised case.
std::string origin_of(const Entry& entry);

}  // namespace graze::corpus
