// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <fstream>
#include <sstream>
#include <string>

namespace graze {

// A process's state and parent, from the operating system. state: 'R' running, 'D' waiting for a device, 'S' sleeping,
// 'T' or 't' stopped, 'Z' ended; 0 if there is no such process.
struct ProcessStatus {
  char state = '\0';
  pid_t parent = 0;
};

inline ProcessStatus process_status(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(in, line);
  const std::size_t end = line.rfind(") ");
  ProcessStatus status;
  if (end != line.npos) std::istringstream(line.substr(end + 2)) >> status.state >> status.parent;
  return status;
}

inline char process_state(pid_t process) { return process_status(process).state; }

inline bool is_stopped(pid_t process) {
  const char state = process_state(process);
  return state == 'T' || state == 't';
}

}  // namespace graze
