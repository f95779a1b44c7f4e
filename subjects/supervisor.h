// SPDX-License-Identifier: Apache-2.0
// The process between graze and foreign code. It runs none of that code itself: it starts a process that loads the code
// and forks workers from it, hands out questions, judges how long and how much they take, and ends what must end.
#pragma once

#include <cstdint>
#include <string>

namespace graze::subjects {

struct Limits {
  double seconds = 1;        // of processor time for a pair, or for a block of a subject that takes blocks
  double load_seconds = 60;  // to load the code, and to have a worker ready
  std::uint64_t bytes = 0;   // of memory, of all its processes together; 0: unlimited
  std::uint64_t processes = 64;
  bool program = false;  // it answers by lines
};

// Answers blocks on kControlFd until graze closes it, then ends all that it started.
// arguments: of the process that loads the code, which is this program again.
// Returns: the exit status.
int supervise(const Limits& limits, char* const* arguments);

// Runs one program, ends all that it started, and then tells graze its exit status as an int; -1 where it ran too long.
// When graze closes kControlFd before, also removes `scratch`, the folder of its files.
// Returns: the exit status.
int supervise_program(double seconds, const std::string& scratch, char* const* words);

}  // namespace graze::subjects
