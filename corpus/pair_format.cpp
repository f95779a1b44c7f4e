// SPDX-License-Identifier: Apache-2.0
// The text format of pairs and cases. A line is parsed word by word from the left, and every error is reported.
#include "corpus/pair_format.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/cannot.h"
#include "core/text.h"
#include "strata/mesh_readers/soup.h"

namespace graze::corpus {
namespace {

constexpr std::string_view kFormat = "graze-pairs";
constexpr std::string_view kVersion = "1";
constexpr const char* kCoordinatesField = "coordinates";
constexpr const char *kOfFloats = "f32", *kOfDoubles = "f64";
constexpr std::size_t kLongestLine = 65536;  // an endless line is an error, because it would fill the memory

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_printable(char c) { return c >= ' ' && c <= '~'; }
bool is_hex_digit(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }
bool is_key_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

bool is_punctuation(char c) { return std::string_view(",;{}[]()").find(c) != std::string_view::npos; }
bool is_opening(char c) { return std::string_view(",{[(").find(c) != std::string_view::npos; }

// Number i of a pair, from 0, in a message: "number 1 (a[0].x)" to "number 18 (b[2].z)".
std::string numbered(std::size_t i) {
  return "number " + std::to_string(i + 1) + " (" + (i < 9 ? 'a' : 'b') + '[' + "012"[i % 9 / 3] + "]." + "xyz"[i % 3] +
         ')';
}

// The unread rest of a line.
struct Line {
  std::string_view rest;
  std::string where;  // FILE:LINE

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw FormatError(where + ": expected " + expected + ", found " + found);
  }

  // Skips white space.   Returns: whether only a comment or nothing is left.
  bool at_end() {
    while (!rest.empty() && is_space(rest[0])) rest.remove_prefix(1);
    return rest.empty() || rest[0] == '#';
  }

  std::string_view take(std::size_t count) {
    const std::string_view taken = rest.substr(0, count);
    rest.remove_prefix(taken.size());
    return taken;
  }

  // Takes the text before the first character for which `ends` is true.
  template <class Ends>
  std::string_view take_until(const Ends& ends) {
    return take(static_cast<std::size_t>(std::find_if(rest.begin(), rest.end(), ends) - rest.begin()));
  }

  // Takes the text up to the next white space.
  std::string_view take_word() { return take_until(is_space); }

  // Takes the text up to the next white space, punctuation or '|'.
  std::string_view take_number() {
    return take_until([](char c) { return is_space(c) || is_punctuation(c) || c == '|'; });
  }
};

// Skips text such as "float t[2][3][3] =", or "Vec3 a" before a bracket.   Returns: whether there was such text.
bool skip_name(Line& line) {
  const auto begins = [](const Line& at) {
    return std::isalpha(static_cast<unsigned char>(at.rest[0])) != 0 || at.rest[0] == '_';
  };
  if (!begins(line)) return false;
  if (const std::size_t assigned = line.rest.find('='); assigned < line.rest.find('|')) {
    line.take(assigned + 1);
    return true;
  }
  // Without a "=", one or more names must precede a bracket.
  Line ahead(line);
  while (!ahead.at_end() && begins(ahead))
    ahead.take_until([](char c) { return !is_key_char(c) && c != ':' && c != '<' && c != '>'; });
  if (ahead.at_end() || std::string_view("([{").find(ahead.rest[0]) == std::string_view::npos) return false;
  line = ahead;
  return true;
}

// Accepts "1.5", or "1.5f" as in C.   Returns: the number without the suffix; empty if the word is not a number.
std::string_view number_in(std::string_view word) {
  if (parse_float64(word)) return word;
  const bool suffix = word.size() > 1 && (word.back() == 'f' || word.back() == 'F');
  const char before = suffix ? word[word.size() - 2] : ' ';
  if (!(before == '.' || (before >= '0' && before <= '9'))) return {};
  word.remove_suffix(1);
  return parse_float64(word) ? word : std::string_view();
}

bool is_hex(std::string_view number) { return number.find('x') != number.npos || number.find('X') != number.npos; }

// The numbers read so far for the current entry. An entry may span several lines.
struct Draft {
  Entry entry;
  std::size_t count = 0;
  bool open = false;                       // the last line ended with a comma or an opening bracket
  std::string where;                       // FILE:LINE of the first line with a number
  std::optional<std::size_t> only_double;  // the first number that needs a double
};

// Whether the exponent has more than five digits; because the oracle reads numbers exactly, such a number could fill
// memory.
bool has_long_exponent(std::string_view number) {
  const std::size_t at = number.find_first_of(is_hex(number) ? "pP" : "eE");
  if (at == number.npos) return false;
  const std::string_view exponent = number.substr(at + 1);
  return exponent.size() > (exponent[0] == '-' || exponent[0] == '+' ? 6 : 5);
}

// Takes the line's numbers, up to its end or a '|'.
void take_numbers(Line& line, Draft& draft) {
  for (;;) {
    while (!line.at_end() && is_punctuation(line.rest[0])) draft.open = is_opening(line.take(1)[0]);
    if (line.at_end() || line.rest[0] == '|' || line.rest.starts_with("//")) return;
    if (draft.count % 3 == 0 && draft.count < kCoordinates && !parse_float64(Line(line).take_number()) &&
        skip_name(line)) {
      draft.open = true;
      continue;
    }
    const std::string_view word = line.take_number(), number = number_in(word);
    draft.open = false;
    if (draft.count < kCoordinates) {
      if (number.empty()) line.fail("a number as " + numbered(draft.count), shown(word));
      if (has_long_exponent(number)) line.fail("a number with an exponent of at most five digits", shown(word));
      if (draft.count == 0) draft.where = line.where;
      const double value = *parse_float64(number);
      const std::optional<float> stored = parse_float32(number);
      const bool fits = stored && !(is_hex(number) && double{*stored} != value && !std::isnan(value));
      if (!fits && !draft.only_double) draft.only_double = draft.count;
      coordinates(draft.entry.pair)[draft.count] = stored ? *stored : static_cast<float>(value);
      draft.entry.written.emplace_back(number);
    } else if (number.empty()) {
      line.fail("'|' or the end of the line after 18 numbers", shown(word));
    }
    ++draft.count;
  }
}

// Takes the rest of a quoted value, after its opening quote.
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
  const std::string key(line.take_until([](char c) { return !is_key_char(c); }));
  const bool has_value = line.take(1) == "=" && !line.rest.empty() && !is_space(line.rest[0]);
  if (key.empty() || !has_value) line.fail("a field key=value", shown(Line(whole).take_word()));
  if (line.rest[0] != '"') return {key, std::string(line.take_word())};
  line.take(1);
  return {key, take_quoted(line, key)};
}

void take_fields(Line& line, Entry& entry) {
  if (line.at_end() || line.rest[0] != '|') return;
  line.take(1);
  while (!line.at_end()) {
    auto next = take_field(line);
    if (field(entry, next.first)) line.fail("each field only once", "a second " + next.first);
    entry.fields.push_back(std::move(next));
  }
}

// Determines the pair's coordinate type once its fields are known.
void take_type(Draft& draft, PairTypes taken) {
  Entry& entry = draft.entry;
  const std::string* type = field(entry, kCoordinatesField);
  const auto refuse = [&](const std::string& why) { throw FormatError(draft.where + ": " + why); };
  if (type && *type != kOfFloats && *type != kOfDoubles)
    refuse("expected coordinates=f32 or coordinates=f64, found " + shown(*type));
  const auto number = [&] {
    const std::size_t i = draft.only_double.value_or(0);
    return numbered(i) + ", " + shown(entry.written[i]);
  };
  if (type ? *type == kOfFloats : !draft.only_double) {
    if (draft.only_double) refuse("coordinates=f32, but float32 cannot hold " + number());
    return;
  }
  if (taken == PairTypes::f32)
    refuse("expected coordinates in float32, found doubles: " +
           (draft.only_double ? "float32 cannot hold " + number() : "coordinates=f64"));
  DoublePair& pair = entry.doubles.emplace();
  for (std::size_t i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = *parse_float64(entry.written[i]);
  entry.pair = stored_in_float32(pair);
}

// Whether the line belongs to an OBJ file.
bool is_obj(Line line) {
  const std::string_view word = line.take_word();
  constexpr std::string_view kKeywords[] = {"v", "vt", "vn", "o", "g", "s", "mtllib", "usemtl"};
  return std::find(std::begin(kKeywords), std::end(kKeywords), word) != std::end(kKeywords);
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

Entry entry_of(const AnyPair& pair, std::vector<std::pair<std::string, std::string>> fields) {
  if (pair.floats) return {*pair.floats, std::move(fields)};
  Entry entry{stored_in_float32(pair.doubles), std::move(fields)};
  entry.doubles = pair.doubles;
  return entry;
}

AnyPair pair_of(const Entry& entry) {
  return visit(entry, [](const auto& pair) { return AnyPair(pair); });
}

PairReader::PairReader(std::istream& in, std::string name, PairTypes taken)
    : in_(in), name_(std::move(name)), taken_(taken) {}

bool PairReader::read_line(std::string& text) {
  text.clear();
  ++line_;
  std::size_t length = 0;
  for (char c; in_.get(c) && c != '\n';) {
    if (++length <= kLongestLine) text += c;
    if (length == kLongestLine + 1) break;
  }
  if (in_.bad()) throw FormatError(cannot("read", where(), errno != 0 ? errno : EIO));
  if (length > kLongestLine) {
    throw FormatError(where() + ": expected a line of at most " + std::to_string(kLongestLine) +
                      " bytes, found a longer one");
  }
  return length > 0 || !in_.eof();
}

std::string PairReader::where() const { return name_ + ':' + std::to_string(line_); }

// Reads the rest of the stream as an OBJ fragment that begins with the line `text`.
Entry PairReader::read_obj_fragment(std::string text) {
  constexpr std::size_t kLongestFragment = 1 << 20;
  Entry entry;
  entry.line = line_;
  std::string bytes(line_ - 1, '\n');  // so that messages have the stream's line numbers
  const std::string begins = where();
  do {
    bytes += text + '\n';
    if (bytes.size() > kLongestFragment)
      throw FormatError(begins + ": expected an OBJ fragment of at most 1 MiB, found more");
  } while (read_line(text));
  entry.lines = line_ - entry.line;
  strata::Soup soup;
  try {
    soup = strata::read_obj({name_, bytes});
  } catch (const std::runtime_error& error) {
    throw FormatError(error.what());
  }
  if (soup.triangles.empty() && soup.vertices.size() == 6) soup.triangles = {{0, 1, 2}, {3, 4, 5}};
  if (soup.triangles.size() != 2)
    throw FormatError(begins + ": expected two triangles, or six vertices without faces; found " +
                      std::to_string(soup.triangles.size()) + " triangles and " + std::to_string(soup.vertices.size()) +
                      " vertices");
  std::vector<std::array<std::string, 3>> written;  // coordinates as typed, in vertex order
  std::istringstream lines(bytes);
  for (std::string line, keyword; std::getline(lines, line);) {
    std::istringstream words(line);
    if (!(words >> keyword) || keyword != "v") continue;
    auto& [x, y, z] = written.emplace_back();
    words >> x >> y >> z;
  }
  for (std::size_t i = 0; i < kCoordinates; ++i) {
    const std::uint32_t vertex = soup.triangles[i / 9][i / 3 % 3];
    coordinates(entry.pair)[i] = component(soup.vertices[vertex], static_cast<int>(i % 3));
    entry.written.push_back(written.at(vertex)[i % 3]);
  }
  return entry;
}

std::optional<Entry> PairReader::next() {
  std::string text;
  Draft draft;
  const auto expect_18 = [&draft](const std::string& place) {
    throw FormatError(place + ": expected 18 numbers, found " + std::to_string(draft.count));
  };
  while (read_line(text)) {
    if (line_ == 1 && text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);  // a byte order mark
    Line line{text, where()};
    if (line.at_end()) continue;
    if (line.rest.starts_with(kFormat)) {
      if (draft.count > 0) expect_18(draft.where);
      take_version(line);
      versioned_ = true;
      continue;
    }
    if (draft.count == 0 && !versioned_ && is_obj(line)) return read_obj_fragment(text);
    const bool first = draft.count == 0;
    take_numbers(line, draft);
    if (first) draft.entry.line = line_;
    const bool fields = !line.at_end() && line.rest[0] == '|';
    if (draft.count == 0 && !fields) continue;  // the line has only brackets or an array's name
    if (draft.count < kCoordinates && !fields && !versioned_ && (draft.open || draft.count % 3 == 0)) continue;
    if (draft.count != kCoordinates) expect_18(draft.count == 0 ? line.where : draft.where);
    draft.entry.lines = line_ - draft.entry.line + 1;
    take_fields(line, draft.entry);
    take_type(draft, taken_);
    return draft.entry;
  }
  if (draft.count > 0) expect_18(draft.where);
  return std::nullopt;
}

std::ifstream open_pairs(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw FormatError(cannot("read", file, EISDIR));
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FormatError(cannot("read", file, errno));
  return in;
}

std::vector<Entry> read_pairs(const std::filesystem::path& file, PairTypes taken) {
  std::ifstream in = open_pairs(file);
  PairReader reader(in, file.string(), taken);
  std::vector<Entry> entries;
  while (std::optional<Entry> entry = reader.next()) entries.push_back(std::move(*entry));
  return entries;
}

void write_header(std::ostream& out) { out << kFormat << ' ' << kVersion << '\n'; }

void write_entry(std::ostream& out, const Entry& entry) {
  const DoublePair pair = entry.doubles.value_or(in_doubles(entry.pair));
  for (int i = 0; i < kCoordinates; ++i) out << (i == 0 ? "" : " ") << hex_float(coordinates(pair)[i]);
  const bool says_type = entry.doubles && !field(entry, kCoordinatesField);
  if (says_type || !entry.fields.empty()) out << " |";
  if (says_type) out << ' ' << kCoordinatesField << '=' << kOfDoubles;
  for (const auto& [key, value] : entry.fields) {
    out << ' ' << key << '=' << (is_bare(value) ? value : in_quotes(value));
  }
  out << '\n';
}

std::string hex_float(double value) {
  if (std::isnan(value)) return "nan";
  std::string text = std::signbit(value) ? "-" : "";
  if (std::isinf(value)) return text + "inf";
  char digits[32];
  const auto end = std::to_chars(std::begin(digits), std::end(digits), std::fabs(value), std::chars_format::hex).ptr;
  return text.append("0x").append(digits, end);
}

const std::string* field(const Entry& entry, std::string_view key) {
  for (const auto& [name, value] : entry.fields) {
    if (name == key) return &value;
  }
  return nullptr;
}

std::string text_of(const Entry& entry, std::string_view key) {
  const std::string* value = field(entry, key);
  return value ? *value : "";
}

std::string origin_of(const Entry& entry) { return numbers_of(entry).value_or(text_of(entry, "from")); }

std::optional<std::string> numbers_of(const Entry& entry) {
  const std::string *stratum = field(entry, "stratum"), *seed = field(entry, "seed"), *index = field(entry, "index");
  if (!stratum || !seed || !index) return std::nullopt;
  const std::string* scene = field(entry, "scene");
  return *stratum + (scene ? '@' + *scene : "") + ':' + *seed + ':' + *index;
}

}  // namespace graze::corpus
