// SPDX-License-Identifier: Apache-2.0
#include "cli/screen.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/text.h"

namespace graze::cli {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

reports::Screen screen_of(int file_descriptor) {
  reports::Screen screen;
  if (!isatty(file_descriptor)) return screen;
  constexpr std::uint64_t kMost = 1000;
  winsize size{};
  if (ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    screen.columns = static_cast<int>(std::min<std::uint64_t>(size.ws_col, kMost));
  } else if (const auto columns = parse_whole(environment("COLUMNS")); columns && *columns > 0) {
    screen.columns = static_cast<int>(std::min(*columns, kMost));
  }
  // NO_COLOR counts if it is set and not empty, as no-color.org requires.
  screen.colour = environment("NO_COLOR").empty() && environment("TERM") != "dumb";
  return screen;
}

}  // namespace

reports::Screen output_screen() { return screen_of(STDOUT_FILENO); }
reports::Screen error_screen() { return screen_of(STDERR_FILENO); }

void print_wrapped(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) fmt::print("{}", reports::wrapped(sentence, output_screen().columns));
}

bool LimitedText::add(const std::string& block) {
  const int lines = static_cast<int>(std::count(block.begin(), block.end(), '\n'));
  complete_ = complete_ && lines <= left_;
  if (!complete_) return false;
  left_ -= lines;
  text_ += block;
  return true;
}

}  // namespace graze::cli
