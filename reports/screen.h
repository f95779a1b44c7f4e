// SPDX-License-Identifier: Apache-2.0
// The properties of the output: its columns, and whether it shows colour. Files and pipes get the defaults, so a
// command writes the same bytes everywhere.
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

// The text's width in columns, which is its number of code points.   Requires: UTF-8 without colour codes.
int width_of(std::string_view text);

// Wraps the text at spaces into lines of at most `columns`; a longer word gets its own line. The first line is indented
// by `indent`, and each further line by `hang`. Every line ends with a newline.
std::string wrapped(std::string_view text, int columns, int indent = 0, int hang = 0);

}  // namespace graze::reports
