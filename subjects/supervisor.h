// SPDX-License-Identifier: Apache-2.0
// The supervisor is the process between graze and foreign code. The supervisor runs no foreign code itself. It starts a
// process that loads the code and forks workers, sends questions to workers, and ends processes that exceed a limit.
#pragma once

#include <cstdint>
#include <string>

namespace graze::subjects {

struct Limits {
  double seconds = 1;       // processor time for a pair, or for a block of a subject that takes blocks
  std::uint64_t bytes = 0;  // memory of all the code's processes together; 0: unlimited
  bool program = false;     // a separate program answers
  bool has_code = true;     // there is a file to load
  bool system_v = false;    // the code may make System V memory, semaphores and message queues, as they have limits
};

// Answers blocks on kControlFd until graze closes that socket. After that, ends all processes that were started, and
// exits. arguments: the command line of the process that loads the code. That process runs this program too.
int supervise(const Limits& limits, char* const* arguments);

// Runs a program, ends all processes that the program started, and sends its exit status to graze as an int. The status
// is -1 when the program ran too long. The status is kTookTooMuchMemory when the processes of the program used more
// than `bytes` together. If graze closes kControlFd first, removes the program's temporary folder `scratch` too.
// Returns: the exit status of this supervisor.
int supervise_program(double seconds, std::uint64_t bytes, const std::string& scratch, char* const* words);

}  // namespace graze::subjects
