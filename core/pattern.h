// SPDX-License-Identifier: Apache-2.0
// std::regex for text from outside. libstdc++ matches by recursion, one call or more for each character, so that a long
// text overflows the stack. These functions match at most kMostMatched characters at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <regex>
#include <string>

namespace graze {

inline constexpr std::size_t kMostMatched = 4096;

// Whether the whole text matches the pattern; false for a text longer than kMostMatched.
inline bool matches(const std::string& text, std::smatch& match, const std::regex& pattern) {
  return text.size() <= kMostMatched && std::regex_match(text, match, pattern);
}

inline bool matches(const std::string& text, const std::regex& pattern) {
  std::smatch match;
  return matches(text, match, pattern);
}

// Whether the text contains the pattern. Each run of white space in the text counts as its first character. A place of
// more than kMostMatched / 2 characters may not be found.
inline bool contains(std::string text, const std::regex& pattern) {
  const auto is_space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  text.erase(
      std::unique(text.begin(), text.end(), [&](char left, char right) { return is_space(left) && is_space(right); }),
      text.end());
  for (std::size_t first = 0;; first += kMostMatched / 2) {
    const std::size_t last = std::min(first + kMostMatched, text.size());
    const auto at = [&](std::size_t i) { return text.cbegin() + static_cast<std::ptrdiff_t>(i); };
    using namespace std::regex_constants;
    if (std::regex_search(at(first), at(last), pattern, first == 0 ? match_default : match_prev_avail)) return true;
    if (last == text.size()) return false;
  }
}

}  // namespace graze
