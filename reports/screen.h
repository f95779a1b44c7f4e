// SPDX-License-Identifier: Apache-2.0
// What text is printed on: how many columns it has, and whether it shows colour. The default is what files and pipes
// get, so that the same command prints the same bytes everywhere.
#pragma once

#include <string>
#include <string_view>

namespace graze::reports {

struct Screen {
  int columns = 80;
  bool colour = false;
};

std::string bold(const Screen& screen, std::string_view text);
std::string red(const Screen& screen, std::string_view text);

// Columns that the text takes: its code points.   Requires: UTF-8 without colour.
int width_of(std::string_view text);

// The text in lines of at most `columns`, broken at its spaces; a longer word has a line of its own. The first line is
// indented by `indent`, the others by `hang`. Every line ends with a newline.
std::string wrapped(std::string_view text, int columns, int indent = 0, int hang = 0);

}  // namespace graze::reports
