// SPDX-License-Identifier: Apache-2.0
#include "core/text.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>
#include <system_error>

namespace graze {
namespace {

constexpr std::size_t kLongestQuote = 40;  // of foreign text in a message

bool is_hex_digit(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

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

}  // namespace

std::optional<float> parse_float32(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const std::string magnitude_text(text);
  if (hex) text.remove_prefix(2);
  if (text.empty() || text[0] == '-' || (hex && text[0] != '.' && !is_hex_digit(text[0]))) return std::nullopt;

  float magnitude = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), magnitude,
                                            hex ? std::chars_format::hex : std::chars_format::general);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say which way; strtof rounds what underflows and returns infinity otherwise.
    magnitude = std::strtof(magnitude_text.c_str(), nullptr);
    if (std::isinf(magnitude)) return std::nullopt;
  }
  return negative ? -magnitude : magnitude;
}

std::optional<std::uint64_t> parse_whole(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
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

std::string shown(std::string_view text) {
  return text.size() <= kLongestQuote ? in_quotes(text) : in_quotes(text.substr(0, kLongestQuote)) + "...";
}

}  // namespace graze
