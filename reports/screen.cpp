// SPDX-License-Identifier: Apache-2.0
#include "reports/screen.h"

#include <fmt/color.h>

#include <algorithm>

namespace graze::reports {

std::string bold(const Screen& screen, std::string_view text) {
  return screen.colour ? fmt::format(fmt::emphasis::bold, "{}", text) : std::string(text);
}

std::string red(const Screen& screen, std::string_view text) {
  return screen.colour ? fmt::format(fmt::emphasis::bold | fmt::fg(fmt::terminal_color::red), "{}", text)
                       : std::string(text);
}

int width_of(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & '\xc0') != '\x80'; }));
}

std::string wrapped(std::string_view text, int columns, int indent, int hang) {
  std::string result, line(static_cast<std::size_t>(indent), ' ');
  bool empty = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    if (!empty && width_of(line) + 1 + width_of(word) > columns) {
      result += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
      line.assign(static_cast<std::size_t>(hang), ' ');
      empty = true;
    }
    if (!empty) line += ' ';
    line += word;
    empty = empty && word.empty();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result + line + '\n';
}

}  // namespace graze::reports
