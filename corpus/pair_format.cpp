// SPDX-License-Identifier: Apache-2.0
// The text format of pairs and cases: a line is cut from the left, word by word, and every misfit is named.
#include "corpus/pair_format.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>

#include "core/text.h"

namespace graze::corpus {
namespace {

constexpr std::string_view kFormat = "graze-pairs";
constexpr std::string_view kVersion = "1";
constexpr std::size_t kLongestLine = 65536;  // so that an endless line is an error, not all of the memory

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_printable(char c) { return c >= ' ' && c <= '~'; }
bool is_hex_digit(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }
bool is_key_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

// The name of coordinate i of a pair: a[0].x ... b[2].z.
std::string coordinate_name(std::size_t i) {
  return {i < 9 ? 'a' : 'b', '[', "012"[i % 9 / 3], ']', '.', "xyz"[i % 3]};
}

// What is left of a line that is being read.
struct Line {
  std::string_view rest;
  std::string where;  // FILE:LINE

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw FormatError(where + ": expected " + expected + ", found " + found);
  }

  // Skips white space.   Returns: whether nothing or a comment is left.
  bool at_end() {
    while (!rest.empty() && is_space(rest[0])) rest.remove_prefix(1);
    return rest.empty() || rest[0] == '#';
  }

  std::string_view take(std::size_t count) {
    const std::string_view taken = rest.substr(0, count);
    rest.remove_prefix(taken.size());
    return taken;
  }

  // Takes what stands before white space, or before stop.
  std::string_view take_word(char stop = ' ') {
    const auto end = std::find_if(rest.begin(), rest.end(), [stop](char c) { return is_space(c) || c == stop; });
    return take(static_cast<std::size_t>(end - rest.begin()));
  }
};

Pair take_pair(Line& line) {
  Pair pair{};
  std::size_t count = 0;
  while (!line.at_end() && line.rest[0] != '|') {
    const std::string_view word = line.take_word('|');
    const std::optional<float> number = parse_float32(word);
    if (count < kCoordinates) {
      if (!number) {
        line.fail("a float32 as number " + std::to_string(count + 1) + " (" + coordinate_name(count) + ")",
                  shown(word));
      }
      coordinates(pair)[count] = *number;
    } else if (!number) {
      line.fail("'|' or the end of the line after 18 numbers", shown(word));
    }
    ++count;
  }
  if (count != kCoordinates) line.fail("18 numbers", std::to_string(count));
  return pair;
}

// Takes a value in quotes, the first of which is taken already.
std::string take_quoted(Line& line, const std::string& key) {
  std::string value;
  while (!line.rest.empty()) {
    const char c = line.take(1)[0];
    if (c == '"') {
      if (!line.rest.empty() && !is_space(line.rest[0])) {
        line.fail("white space after the value of " + key, shown(line.take_word()));
      }
      return value;
    }
    if (c != '\\') {
      value += c;
    } else if (line.rest.starts_with('"') || line.rest.starts_with('\\')) {
      value += line.take(1);
    } else if (line.rest.size() >= 3 && line.rest[0] == 'x' && is_hex_digit(line.rest[1]) &&
               is_hex_digit(line.rest[2])) {
      const std::string_view digits = line.take(3).substr(1);
      unsigned byte = 0;
      std::from_chars(digits.begin(), digits.end(), byte, 16);
      value += static_cast<char>(byte);
    } else {
      line.fail(R"(\", \\ or \xHH in the value of )" + key, shown(std::string("\\").append(line.take(1))));
    }
  }
  line.fail("a closing quote in the value of " + key, "the end of the line");
}

std::pair<std::string, std::string> take_field(Line& line) {
  const Line whole = line;
  const auto key_end = std::find_if_not(line.rest.begin(), line.rest.end(), is_key_char);
  const std::string key(line.take(static_cast<std::size_t>(key_end - line.rest.begin())));
  const bool has_value = line.take(1) == "=" && !line.rest.empty() && !is_space(line.rest[0]);
  if (key.empty() || !has_value) line.fail("a field key=value", shown(Line(whole).take_word()));
  if (line.rest[0] != '"') return {key, std::string(line.take_word())};
  line.take(1);
  return {key, take_quoted(line, key)};
}

Entry take_entry(Line& line) {
  Entry entry;
  entry.pair = take_pair(line);
  if (line.at_end()) return entry;
  line.take(1);  // the '|' that take_pair stopped at
  while (!line.at_end()) {
    auto next = take_field(line);
    if (field(entry, next.first)) line.fail("every field once", "a second " + next.first);
    entry.fields.push_back(std::move(next));
  }
  return entry;
}

void take_version(Line& line) {
  const std::string_view whole = line.rest;
  line.take_word();
  line.at_end();
  const bool known = line.take_word() == kVersion && line.at_end();
  if (!known) line.fail("the version line \"" + std::string(kFormat) + ' ' + std::string(kVersion) + '"', shown(whole));
}

bool is_bare(std::string_view value) {
  return !value.empty() && value[0] != '"' &&
         std::all_of(value.begin(), value.end(), [](char c) { return is_printable(c) && c != ' '; });
}

}  // namespace

PairReader::PairReader(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {}

bool PairReader::read_line(std::string& text) {
  text.clear();
  ++line_;
  std::size_t length = 0;
  for (char c; in_.get(c) && c != '\n';) {
    if (++length <= kLongestLine) text += c;
    if (length == kLongestLine + 1) break;
  }
  const std::string where = name_ + ':' + std::to_string(line_);
  if (in_.bad()) throw FormatError(where + ": expected text, found an error of reading");
  if (length > kLongestLine) {
    throw FormatError(where + ": expected a line of at most " + std::to_string(kLongestLine) +
                      " bytes, found a longer one");
  }
  return length > 0 || !in_.eof();
}

std::optional<Entry> PairReader::next() {
  std::string text;
  while (read_line(text)) {
    Line line{text, name_ + ':' + std::to_string(line_)};
    if (line.at_end()) continue;
    if (line.rest.starts_with(kFormat)) {
      take_version(line);
      continue;
    }
    Entry entry = take_entry(line);
    entry.line = line_;
    return entry;
  }
  return std::nullopt;
}

std::ifstream open_pairs(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::string name = file.string();
  if (!std::filesystem::exists(file, ignored)) throw FormatError(name + ": expected a file of pairs, found none");
  if (std::filesystem::is_directory(file, ignored)) {
    throw FormatError(name + ": expected a file of pairs, found a folder");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FormatError(name + ": expected a file of pairs, found one that cannot be opened");
  return in;
}

std::vector<Entry> read_pairs(const std::filesystem::path& file) {
  std::ifstream in = open_pairs(file);
  PairReader reader(in, file.string());
  std::vector<Entry> entries;
  while (std::optional<Entry> entry = reader.next()) entries.push_back(std::move(*entry));
  return entries;
}

void write_header(std::ostream& out) { out << kFormat << ' ' << kVersion << '\n'; }

void write_entry(std::ostream& out, const Entry& entry) {
  for (int i = 0; i < kCoordinates; ++i) out << (i == 0 ? "" : " ") << hex_float(coordinates(entry.pair)[i]);
  if (!entry.fields.empty()) out << " |";
  for (const auto& [key, value] : entry.fields) {
    out << ' ' << key << '=' << (is_bare(value) ? value : in_quotes(value));
  }
  out << '\n';
}

std::string hex_float(float value) {
  if (std::isnan(value)) return "nan";
  std::string text = std::signbit(value) ? "-" : "";
  if (std::isinf(value)) return text + "inf";
  char digits[32];
  const double magnitude = std::fabs(value);  // a double, in which a subnormal float is normal: 0x1p-149
  const auto end = std::to_chars(std::begin(digits), std::end(digits), magnitude, std::chars_format::hex).ptr;
  return text.append("0x").append(digits, end);
}

const std::string* field(const Entry& entry, std::string_view key) {
  for (const auto& [name, value] : entry.fields) {
    if (name == key) return &value;
  }
  return nullptr;
}

std::optional<std::string> numbers_of(const Entry& entry) {
  const std::string *stratum = field(entry, "stratum"), *seed = field(entry, "seed"), *index = field(entry, "index");
  if (!stratum || !seed || !index) return std::nullopt;
  return *stratum + ':' + *seed + ':' + *index;
}

}  // namespace graze::corpus
