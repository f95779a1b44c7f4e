// SPDX-License-Identifier: Apache-2.0
// The process between graze and foreign code. It runs no foreign code itself. It starts a process that loads the code
// and forks workers, hands out questions, and ends processes that exceed time or memory limits.
#pragma once

#include <cstdint>
#include <string>

namespace graze::subjects {

struct Limits {
  double seconds = 1;       // processor time for a pair, or for a block of a subject that takes blocks
  std::uint64_t bytes = 0;  // memory of all its processes together; 0: unlimited
  bool program = false;     // a separate program answers
  bool has_code = true;     // there is a file to load
  bool system_v = false;    // it may make System V memory, semaphores and message queues, which have limits then
};

// Answers blocks on kControlFd until graze closes it, then ends all processes that it started.
// arguments: for the process that loads the code, which runs this program again.
// Returns: the exit status.
int supervise(const Limits& limits, char* const* arguments);

// Runs a program, ends all processes that it started, and sends its exit status to graze as an int; -1 when it ran too
// long, kTookTooMuchMemory when all its processes together used more than `bytes`. If graze closes kControlFd first,
// also removes the program's temporary folder `scratch`. Returns: the exit status.
int supervise_program(double seconds, std::uint64_t bytes, const std::string& scratch, char* const* words);

}  // namespace graze::subjects
