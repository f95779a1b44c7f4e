// SPDX-License-Identifier: Apache-2.0
// The properties of the output: its columns, and whether it shows colour. The defaults are for files and pipes, so that
// the same command writes the same bytes everywhere.
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

// The columns that the text takes, which is its number of code points.   Requires: UTF-8 without colour codes.
int width_of(std::string_view text);

// Wraps the text at spaces into lines of at most `columns`; a longer word gets its own line. The first line is indented
// by `indent`, the others by `hang`. Every line ends with a newline.
std::string wrapped(std::string_view text, int columns, int indent = 0, int hang = 0);

}  // namespace graze::reports
