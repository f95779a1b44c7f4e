// SPDX-License-Identifier: Apache-2.0
// The supervisor is the process between graze and foreign code. It runs no foreign code itself: it starts a process
// that loads the code and forks workers, sends questions to workers, and ends processes that exceed a limit.
#pragma once

#include <cstdint>
#include <string>

namespace graze::subjects {

struct Limits {
  double seconds = 1;       // processor time for a pair, or for a block of a subject that takes blocks
  std::uint64_t bytes = 0;  // memory of all the code's processes together; 0: no limit
  bool program = false;     // whether a separate program answers
  bool has_code = true;     // whether there is a file to load
  bool system_v = false;    // System V memory, semaphores and message queues have limits, so the code may make them
};

// Answers blocks on kControlFd until graze closes that socket, then ends all processes that it started, and exits.
// arguments: the command line of the process that loads the code, which runs this program too.
int supervise(const Limits& limits, char* const* arguments);

// Runs a program, ends all processes that it started, and sends its exit status to graze as an int: -1 if the program
// ran too long, kTookTooMuchMemory if its processes together used more than `bytes`. If graze closes kControlFd first,
// also removes the program's temporary folder `scratch`. Returns: the exit status of this supervisor.
int supervise_program(double seconds, std::uint64_t bytes, const std::string& scratch, char* const* words);

}  // namespace graze::subjects
