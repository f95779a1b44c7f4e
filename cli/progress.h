// SPDX-License-Identifier: Apache-2.0
// How far a long run is: one line on a terminal, rewritten five times a second; otherwise a line of its own for every
// tenth of the way, ten seconds apart at least, and when half a minute went by without one.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "reports/screen.h"

namespace graze::cli {

// "45 s", "3 min", "2 h 5 min".
std::string duration(double seconds);

// Parts of a line, those that matter most first: as many as fit on a terminal without filling its last column, where
// some would wrap. A first part that is too wide is cut.
std::string fitting(const std::vector<std::string>& parts, int columns);

class Progress {
 public:
  // things: what is counted, as "signatures". screen: what it is printed on; the terminal, if it is on one.
  Progress(std::string things, std::size_t total, bool on_terminal, const reports::Screen& screen = {})
      : things_(std::move(things)), total_(total), on_terminal_(on_terminal), screen_(screen) {}

  // What to print when so many are done, so many seconds after the start; nothing when it is too soon.
  // Returns: a line that does not wrap. `left` is the estimate; nothing where there is none yet. `more`: what else a
  // terminal shows where there is room.
  std::optional<std::string> line(std::size_t done, double seconds, std::optional<double> left,
                                  const std::vector<std::string>& more = {});

  // Clears the line on a terminal.
  std::string end() const { return on_terminal_ ? "\r\033[K" : ""; }

 private:
  std::string things_;
  std::size_t total_;
  bool on_terminal_;
  reports::Screen screen_;
  double printed_ = 0;      // seconds after the start
  std::size_t tenths_ = 0;  // of the way, when the last line was printed
};

}  // namespace graze::cli
