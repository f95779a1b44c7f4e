// SPDX-License-Identifier: Apache-2.0
// How far a long run is: one line on a terminal, rewritten five times a second; otherwise a line of its own for every
// tenth of the way, ten seconds apart at least.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace graze::cli {

// "45 s", "3 min", "2 h 5 min".
std::string duration(double seconds);

class Progress {
 public:
  // things: what is counted, as "signatures".
  Progress(std::string things, std::size_t total, bool on_terminal)
      : things_(std::move(things)), total_(total), on_terminal_(on_terminal) {}

  // What to print when so many are done, so many seconds after the start; nothing when it is too soon.
  // Returns: at most 79 columns. `left` is the estimate; nothing where there is none yet.
  std::optional<std::string> line(std::size_t done, double seconds, std::optional<double> left);

  // Clears the line on a terminal.
  std::string end() const { return on_terminal_ ? "\r\033[K" : ""; }

 private:
  std::string things_;
  std::size_t total_;
  bool on_terminal_;
  double printed_ = 0;       // seconds after the start
  std::size_t tenths_ = 0;  // of the way, when the last line was printed
};

}  // namespace graze::cli
