// SPDX-License-Identifier: Apache-2.0
// Shows the progress of a long run: on a terminal, in one line that is rewritten five times a second. Elsewhere, a new
// line appears after every tenth of the run, but at most one every ten seconds and at least one every half minute.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "reports/screen.h"

namespace graze::cli {

// "45 s", "3 min", "2 h 5 min".
std::string duration(double seconds);

// Joins as many parts, most important first, as fit on a terminal line. Leaves the last column free, because some
// terminals wrap there. Cuts the first part if it is too wide.
std::string fitting(const std::vector<std::string>& parts, int columns);

class Progress {
 public:
  // things: the name of the counted things, such as "signatures". screen: where the line is printed; used only on a
  // terminal.
  Progress(std::string things, std::size_t total, bool on_terminal, const reports::Screen& screen = {})
      : things_(std::move(things)), total_(total), on_terminal_(on_terminal), screen_(screen) {}

  // Returns the line to print when `done` things are done after `seconds`; nothing if it is too soon. The line does not
  // wrap. `left`: the estimated remaining seconds, if known. `more`: further parts for a terminal, if there is room.
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
  std::size_t tenths_ = 0;  // tenths of the run that were done when the last line was printed
};

}  // namespace graze::cli
