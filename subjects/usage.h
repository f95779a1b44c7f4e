// SPDX-License-Identifier: Apache-2.0
// The processes and the memory of all descendants of this process, from /proc.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <vector>

namespace graze::subjects {

std::vector<pid_t> own_children();  // of the calling thread

// All descendants except those of one child, or a little more than `most` of them.
std::vector<pid_t> descendants(std::uint64_t most, pid_t except = -1);

double processor_seconds(pid_t process);  // that the process has used; 0 if it is not there

// Whether some descendant runs or waits for a processor, and the processor time of all that exist, in seconds.
struct Activity {
  bool wants_processor = false;
  double seconds = 0;
};
Activity activity_of_descendants(std::uint64_t most);

struct Usage {
  std::uint64_t processes,
      bytes;  // of memory and page tables; shared memory counts once, and each process has its share of pages of files
};
// Current usage of all descendants. Stops counting a little beyond `most_bytes` or `most_processes`.
Usage usage_of_descendants(std::uint64_t most_bytes, std::uint64_t most_processes);

}  // namespace graze::subjects
