// SPDX-License-Identifier: Apache-2.0
#include "core/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

namespace graze {
namespace {

constexpr std::size_t kLongestQuote = 40, kLongestPath = 400;  // bytes in a message

bool is_hex_digit(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

std::string general(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

// Appends the byte, as \xHH unless it is printable ASCII.
void append_printable(std::string& text, char c) {
  constexpr char kDigits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  if (c >= ' ' && c <= '~') {
    text += c;
  } else {
    text += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
  }
}

std::string cut_in_quotes(std::string_view text, std::size_t longest) {
  return text.size() <= longest ? in_quotes(text) : in_quotes(text.substr(0, longest)) + "...";
}

float rounded_by_library(const std::string& text, float) { return std::strtof(text.c_str(), nullptr); }
double rounded_by_library(const std::string& text, double) { return std::strtod(text.c_str(), nullptr); }

template <class Real>
std::optional<Real> parse_real(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const std::string magnitude_text(text);
  if (hex) text.remove_prefix(2);
  if (text.empty() || text[0] == '-' || (hex && text[0] != '.' && !is_hex_digit(text[0]))) return std::nullopt;

  Real magnitude = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), magnitude,
                                            hex ? std::chars_format::hex : std::chars_format::general);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not distinguish underflow from overflow; strtof and strtod do: they round, or return infinity.
    magnitude = rounded_by_library(magnitude_text, Real());
    if (std::isinf(magnitude)) return std::nullopt;
  }
  return negative ? -magnitude : magnitude;
}

}  // namespace

std::optional<float> parse_float32(std::string_view text) { return parse_real<float>(text); }
std::optional<double> parse_float64(std::string_view text) { return parse_real<double>(text); }

std::optional<std::uint64_t> parse_whole(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string rounded_up(double value, int digits) {
  const double nearest = std::strtod(general(value, digits).c_str(), nullptr);
  if (nearest >= value) return general(nearest, digits);
  // Takes the next decimal: adds 1 to the last digit.
  char text[32];
  std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
  const int last = std::atoi(std::strchr(text, 'e') + 1) - (digits - 1);
  std::string mantissa;
  for (const char* c = text; *c != 'e'; ++c) {
    if (*c != '.') mantissa += *c;
  }
  std::snprintf(text, sizeof text, "%llde%d", std::atoll(mantissa.c_str()) + 1, last);
  return general(std::strtod(text, nullptr), digits);
}

std::string rounded_down(double value, int digits) {
  const std::string text = rounded_up(-value, digits);
  return text.starts_with('-') ? text.substr(1) : text == "0" ? text : '-' + text;
}

std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) append_printable(result, c);
  return result;
}

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    append_printable(result, c);
  }
  return result + '"';
}

std::string shown(std::string_view text) { return cut_in_quotes(text, kLongestQuote); }

std::string shown_path(std::string_view path) { return cut_in_quotes(path, kLongestPath); }

std::string shell_word(std::string_view word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("_-./:,+@%=").find(c) != std::string_view::npos;
  });
  if (plain) return std::string(word);
  if (std::any_of(word.begin(), word.end(),
                  [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; })) {
    std::string text = "$'";  // so that no control character reaches a terminal
    for (const char c : word) {
      if (c == '\'' || c == '\\') text += '\\';
      append_printable(text, c);
    }
    return text + "'";
  }
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string path_word(std::string_view path) {
  return shell_word(path.starts_with('-') ? "./" + std::string(path) : std::string(path));
}

std::string did_you_mean(std::string_view found, const std::vector<std::string>& candidates) {
  const auto letters = found.size() - static_cast<std::size_t>(std::count(found.begin(), found.end(), '*'));
  std::size_t least = letters / 3 + 1;
  const std::string* nearest = nullptr;
  for (const std::string& candidate : candidates) {
    // Levenshtein distance with one row per character of `found`. A * matches any characters at no cost.
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (const char c : found) {
      std::size_t diagonal = row[0];
      if (c != '*') ++row[0];
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t above = row[j];
        row[j] = c == '*' ? std::min(above, row[j - 1])
                          : std::min({above + 1, row[j - 1] + 1, diagonal + (c == candidate[j - 1] ? 0 : 1)});
        diagonal = above;
      }
    }
    if (row.back() >= least) continue;
    least = row.back();
    nearest = &candidate;
  }
  return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

}  // namespace graze
