// SPDX-License-Identifier: Apache-2.0
#include "subjects/epsilon.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>

#include "core/error.h"
#include "core/text.h"

namespace graze::subjects {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20, kMostListed = 6;
constexpr std::size_t kMostTokens = 64;  // in a constant's value; a longer value is no epsilon
constexpr double kSmall = 1e-3;          // the largest bare number that may be an epsilon to tune
constexpr double kLargest = 0.1;         // the largest number that may cause a wrong verdict
constexpr std::size_t kMostNumbers = 6;  // the most numbers that are listed as possible causes

enum class Kind { word, number, sign, line_end };  // line_end: the end of a directive, such as #define

struct Token {
  Kind kind;
  std::size_t begin, end;
  int line;
};

bool is_in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$'; }

// The tokens of a source in C, C++ or CUDA, without comments, strings and character literals.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {
    while (at_ < text_.size()) next();
    if (in_directive_) add(Kind::line_end, at_);
  }
  std::vector<Token> all;

 private:
  char look(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

  void add(Kind kind, std::size_t end) {
    all.push_back({kind, at_, end, line_});
    at_ = end;
  }

  // Moves on to `end`, counting lines.
  void skip_to(std::size_t end) {
    for (end = std::min(end, text_.size()); at_ < end; ++at_) line_ += text_[at_] == '\n';
  }

  void skip_past(std::string_view ending) {
    const std::size_t found = text_.find(ending, at_);
    skip_to(found == text_.npos ? found : found + ending.size());
  }

  void skip_quoted(char quote) {
    std::size_t end = at_ + 1;
    while (end < text_.size() && text_[end] != quote && text_[end] != '\n') end += text_[end] == '\\' ? 2 : 1;
    skip_to(end + 1);
  }

  void next() {
    const char c = look();
    if (c == '\n') {
      if (in_directive_) add(Kind::line_end, at_);
      in_directive_ = false;
      skip_to(at_ + 1);
    } else if (c == '\\' || std::isspace(static_cast<unsigned char>(c))) {
      skip_to(at_ + (c == '\\' ? 2 : 1));  // a backslash joins two lines
    } else if (c == '/' && look(1) == '/') {
      skip_to(std::min(text_.find('\n', at_), text_.size()));
    } else if (c == '/' && look(1) == '*') {
      at_ += 2;
      skip_past("*/");
    } else if (c == 'R' && look(1) == '"') {
      const std::size_t open = std::min(text_.find('(', at_), text_.size());
      const std::string ending =
          fmt::format("){}\"", text_.substr(std::min(at_ + 2, open), open - std::min(at_ + 2, open)));
      skip_past(ending);
    } else if (c == '"' || c == '\'') {
      skip_quoted(c);
    } else if (std::isdigit(static_cast<unsigned char>(c)) ||
               (c == '.' && std::isdigit(static_cast<unsigned char>(look(1))))) {
      std::size_t end = at_ + 1;
      const auto goes_on = [&] {
        const char d = text_[end], before = text_[end - 1];
        const bool is_sign_of_exponent =
            (d == '+' || d == '-') && std::string_view("eEpP").find(before) != std::string_view::npos;
        return is_in_word(d) || d == '.' || d == '\'' || is_sign_of_exponent;
      };
      while (end < text_.size() && goes_on()) ++end;
      add(Kind::number, end);
    } else if (is_in_word(c)) {
      std::size_t end = at_ + 1;
      while (end < text_.size() && is_in_word(text_[end])) ++end;
      add(Kind::word, end);
    } else {
      in_directive_ = in_directive_ || c == '#';
      add(Kind::sign, at_ + 1);
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool in_directive_ = false;
};

// The value of a number with a point or an exponent; nothing for any other text, such as a whole number.
std::optional<double> value_of(std::string_view written) {
  std::string digits(written);
  std::erase(digits, '\'');
  const bool hexadecimal = digits.starts_with("0x") || digits.starts_with("0X");
  while (!digits.empty() && std::string_view("fFlL").find(digits.back()) != std::string_view::npos &&
         (!hexadecimal || digits.find_first_of("pP") != digits.npos))
    digits.pop_back();
  if (digits.find_first_of(hexadecimal ? "pP" : ".eE") == digits.npos) return std::nullopt;
  const std::string_view number = std::string_view(digits).substr(hexadecimal ? 2 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value,
                                            hexadecimal ? std::chars_format::hex : std::chars_format::general);
  if (error != std::errc() || end != number.data() + number.size()) return std::nullopt;
  return value;
}

bool sounds_like_epsilon(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name.find("eps") != name.npos || name.find("tol") != name.npos;
}

class Finder {
 public:
  explicit Finder(std::string_view text) : text_(text), tokens_(std::move(Tokens(text).all)) {}

  std::vector<Epsilon> operator()() {
    for (std::size_t t = 0; t < tokens_.size(); ++t) {
      if (t < constant_ends_) continue;
      if (const std::optional<std::size_t> first = value_after(t)) {
        add_constant(t, *first);
      } else if (tokens_[t].kind == Kind::number) {
        add_number(t, kSmall);
      }
    }
    return std::move(found_);
  }

  std::vector<Epsilon> small_numbers() {
    for (std::size_t t = 0; t < tokens_.size(); ++t) {
      if (tokens_[t].kind == Kind::number) {
        add_number(t, kLargest);
      } else if (is(t, "FLT_EPSILON") || is(t, "DBL_EPSILON")) {
        add(of(t), t, t + 1, std::nullopt);
      } else if (is(t, "numeric_limits") && is(t + 1, "<") && is(t + 3, ">") && is(t + 6, "epsilon") &&
                 is(t + 8, ")")) {
        const std::size_t first = t >= 3 && is(t - 3, "std") ? t - 3 : t;
        add(std::string(text_.substr(tokens_[first].begin, tokens_[t + 8].end - tokens_[first].begin)), first, t + 9,
            std::nullopt);
      }
    }
    if (found_.size() > kMostNumbers) found_.resize(kMostNumbers);
    return std::move(found_);
  }

 private:
  std::string of(std::size_t t) const {
    return std::string(text_.substr(tokens_[t].begin, tokens_[t].end - tokens_[t].begin));
  }
  bool is(std::size_t t, std::string_view word) const { return t < tokens_.size() && of(t) == word; }

  // If token t is the name of a constant, the first token of its value: NAME = VALUE, NAME{VALUE}, #define NAME VALUE.
  std::optional<std::size_t> value_after(std::size_t t) const {
    if (tokens_[t].kind != Kind::word) return std::nullopt;
    const std::size_t first = t + 2;
    if (t >= 2 && is(t - 1, "define") && is(t - 2, "#")) {
      const bool has_parameters = is(t + 1, "(") && tokens_[t + 1].begin == tokens_[t].end;
      return has_parameters ? std::nullopt : std::optional(t + 1);
    }
    const bool in_braces = is(t + 1, "{") && t + 2 < tokens_.size() && tokens_[t + 2].kind == Kind::number;
    if (!in_braces && !(is(t + 1, "=") && !is(t + 2, "="))) return std::nullopt;
    // A declaration has a type before its first name, and commas between names. "x = 1e-3;" only changes a variable.
    while (t != next_name_ && t >= 2 && is(t - 1, ",") && tokens_[t - 2].kind == Kind::word) t -= 2;
    const bool declared = t == next_name_ || (t >= 1 && tokens_[t - 1].kind == Kind::word && !is(t - 1, "return"));
    return declared ? std::optional(first) : std::nullopt;
  }

  // The token after the value that starts at token `first`. A macro's value ends with its line, any other value at the
  // next , ; ) or } outside brackets.   Returns: `first` if no short value starts there.
  std::size_t end_of_value(std::size_t first) const {
    const bool of_macro = first >= 3 && is(first - 2, "define") && is(first - 3, "#");
    int depth = 0;
    std::size_t t = first;
    for (; t < tokens_.size() && tokens_[t].kind != Kind::line_end; ++t) {
      const std::string sign = of_macro ? "" : of(t);
      if (depth == 0 && (sign == "," || sign == ";" || sign == ")" || sign == "}")) break;
      depth += sign == "(" || sign == "{" || sign == "[";
      depth -= sign == ")" || sign == "}" || sign == "]";
      if (t - first == kMostTokens) return first;
    }
    return t == tokens_.size() ? first : t;
  }

  void add_constant(std::size_t t, std::size_t first) {
    const std::size_t end = end_of_value(first);
    if (end == first) return;
    if (is(end, ",")) next_name_ = end + 1;
    const std::string name = of(t);
    std::size_t begin_number = first, end_number = end;
    while (end_number - begin_number > 2 && is(begin_number, "(") && is(end_number - 1, ")"))
      ++begin_number, --end_number;
    const bool is_number = end_number - begin_number == 1;
    const std::optional<double> value = is_number ? value_of(of(begin_number)) : std::nullopt;
    if (!value && !sounds_like_epsilon(name)) return;  // the value may still contain a bare number
    if (!value) begin_number = first, end_number = end;
    constant_ends_ = end;
    add(name, begin_number, end_number, value);
  }

  void add_number(std::size_t t, double largest) {
    const std::optional<double> value = value_of(of(t));
    if (value && *value > 0 && *value <= largest) add(of(t), t, t + 1, value);
  }

  void add(const std::string& name, std::size_t first, std::size_t end, std::optional<double> value) {
    const SourcePlace place{tokens_[first].begin, tokens_[end - 1].end, tokens_[first].line};
    const auto [known, is_new] = index_.emplace(name, found_.size());
    if (is_new) found_.push_back({name, std::string(text_.substr(place.begin, place.end - place.begin)), value, {}});
    found_[known->second].places.push_back(place);
  }

  std::string_view text_;
  std::vector<Token> tokens_;
  std::vector<Epsilon> found_;
  std::map<std::string, std::size_t> index_;  // the index in found_, by name
  std::size_t next_name_ = ~std::size_t{0};   // the token after the last constant's value and a comma
  std::size_t constant_ends_ = 0;             // the token after the value of the last constant that was added
};

std::string listed(const std::filesystem::path& source, const std::vector<Epsilon>& epsilons) {
  std::vector<std::string> words;
  for (const Epsilon& e : epsilons) {
    if (words.size() == kMostListed) {
      words.push_back(fmt::format("{} more", epsilons.size() - kMostListed));
      break;
    }
    words.push_back(fmt::format("{} at {}", printable(e.name), places_in_words(source, e)));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

void expect_size(std::string_view text) {
  if (text.size() > kMostBytes)
    throw std::runtime_error(fmt::format("expected a source of at most {} bytes, found {}", kMostBytes, text.size()));
}

}  // namespace

std::vector<Epsilon> epsilons_in(std::string_view text) {
  expect_size(text);
  return Finder(text)();
}

std::vector<Epsilon> small_numbers_in(std::string_view text) {
  expect_size(text);
  return Finder(text).small_numbers();
}

Epsilon epsilon_of(const std::filesystem::path& source, std::string_view text, const std::string& name) {
  const std::vector<Epsilon> all = epsilons_in(text);
  const std::string file = printable(source.filename().string());
  if (!name.empty()) {
    for (const Epsilon& e : all) {
      if (e.name == name) return e;
    }
    throw UsageError(fmt::format("--epsilon {}: {} has no such constant with a value{}", printable(name), file,
                                 all.empty() ? "" : "; it has " + listed(source, all)));
  }
  std::vector<Epsilon> named, small;
  for (const Epsilon& e : all) {
    if (sounds_like_epsilon(e.name)) named.push_back(e);
    if (e.value && *e.value > 0 && *e.value <= kSmall) small.push_back(e);
  }
  const std::vector<Epsilon>& candidates = named.empty() ? small : named;
  if (candidates.size() == 1) return candidates.front();
  if (candidates.empty()) {
    throw UsageError(fmt::format(
        "found no epsilon in {}: no constant with eps or tol in its name, and no number from 0 to {}; name the "
        "constant with --epsilon",
        file, kSmall));
  }
  throw UsageError(fmt::format("{} has several numbers that may be the epsilon: {}; name one with --epsilon", file,
                               listed(source, candidates)));
}

std::string written_value(const Epsilon& epsilon, double value) {
  std::string text = fmt::format("{:.9g}", value);
  if (text.find_first_of(".e") == text.npos) text += ".0";
  const std::size_t suffix = epsilon.written.find_last_not_of("fFlL") + 1;
  return epsilon.value ? text + epsilon.written.substr(suffix) : text;
}

std::string with_value(std::string_view text, const std::vector<Epsilon>& epsilons, double value,
                       SourceLanguage language) {
  std::map<std::size_t, std::pair<std::size_t, const Epsilon*>> places;  // by first byte: the end, and the epsilon
  for (const Epsilon& epsilon : epsilons) {
    for (const SourcePlace& place : epsilon.places) places[place.begin] = {place.end, &epsilon};
  }
  std::string result;
  std::size_t from = 0;
  for (const auto& [begin, place] : places) {
    const auto& [end, epsilon] = place;
    result += text.substr(from, begin - from);
    const std::string_view before = text.substr(begin, end - begin);
    const std::string number = written_value(*epsilon, value);
    result += epsilon->value                    ? number
              : language == SourceLanguage::cpp ? fmt::format("(static_cast<decltype({})>({}))", before, number)
                                                : fmt::format("((__typeof__({}))({}))", before, number);
    from = end;
  }
  return result.append(text.substr(from));
}

std::string places_in_words(const std::filesystem::path& source, const Epsilon& epsilon) {
  std::vector<int> lines;
  for (const SourcePlace& place : epsilon.places) {
    if (lines.empty() || lines.back() != place.line) lines.push_back(place.line);
  }
  std::string words = fmt::format("{}:{}", printable(source.filename().string()), lines.front());
  for (std::size_t i = 1; i < lines.size(); ++i)
    words += (i + 1 == lines.size() ? " and " : ", ") + std::to_string(lines[i]);
  return words;
}

}  // namespace graze::subjects
