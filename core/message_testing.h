// SPDX-License-Identifier: Apache-2.0
// For tests of messages: they check what a message names (a file, a line, a value, a limit), not its wording.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace graze {

inline bool has_word(std::string_view text, std::string_view word) {
  const auto inside = [&](std::size_t i) {
    return i < text.size() && std::isalnum(static_cast<unsigned char>(text[i]));
  };
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; ++at)
    if (!(at > 0 && inside(at - 1)) && !inside(at + word.size())) return true;
  return false;
}

// Success if the message is one line and has each of the words; a word may contain spaces, such as "byte 80".
inline testing::AssertionResult names(const std::string& message, const std::vector<std::string>& words) {
  if (words.empty()) return testing::AssertionFailure() << "no words to look for";
  if (message.find('\n') != std::string::npos) return testing::AssertionFailure() << "several lines: " << message;
  for (const std::string& word : words)
    if (!has_word(message, word)) return testing::AssertionFailure() << "no '" << word << "' in: " << message;
  return testing::AssertionSuccess();
}

// The message of the Error that act() throws; empty if it throws none.
template <class Error = std::runtime_error, class Act>
std::string error_of(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace graze
