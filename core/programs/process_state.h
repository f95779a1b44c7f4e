// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <fstream>
#include <string>

namespace graze {

// The state that the system reports for a process: 'R' running, 'D' waiting for a device, 'S' sleeping, 'T' or 't'
// stopped, 'Z' ended; 0 if there is no such process.
inline char process_state(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(in, line);
  const std::size_t end = line.rfind(") ");
  return end != line.npos && end + 2 < line.size() ? line[end + 2] : '\0';
}

inline bool is_stopped(pid_t process) {
  const char state = process_state(process);
  return state == 'T' || state == 't';
}

}  // namespace graze
