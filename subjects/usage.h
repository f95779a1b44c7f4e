// SPDX-License-Identifier: Apache-2.0
// Counts this process's descendants, and their memory, descriptors and processor time, from /proc.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <vector>

namespace graze::subjects {

// The children of the calling thread.
std::vector<pid_t> own_children();

// All descendants except the child `except` and its descendants. The search stops once there are more than `most`.
std::vector<pid_t> descendants(std::uint64_t most, pid_t except = -1);

// The processor time that the process has used, in seconds; 0 if there is no such process.
double processor_seconds(pid_t process);

// Whether any descendant runs or waits for a processor, and the processor time of all descendants, in seconds.
struct Activity {
  bool wants_processor = false;
  double seconds = 0;
};
Activity activity_of_descendants(std::uint64_t most);

// The limit on open descriptors in each process of foreign code.
inline constexpr std::uint64_t kDescriptorsOfAProcess = 1024;

struct Usage {
  std::uint64_t processes;
  // Memory and page tables. Shared memory counts once. A file's page counts in part for each process that maps it.
  std::uint64_t bytes;
  // Open descriptors. The buffers of pipes and sockets are system memory, which is not in `bytes`.
  std::uint64_t descriptors;

  bool within(const Usage& most) const {
    return processes <= most.processes && bytes <= most.bytes && descriptors <= most.descriptors;
  }
};
// The current usage of all descendants. Counting stops soon after it exceeds `most`.
Usage usage_of_descendants(const Usage& most);

}  // namespace graze::subjects
