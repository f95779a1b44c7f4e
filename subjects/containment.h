// SPDX-License-Identifier: Apache-2.0
// What holds the processes of foreign code together, so that none outlives its supervisor: a process namespace of their
// own where the system allows one, else the supervisor as the subreaper of its descendants.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace graze::subjects {

// The calling process becomes the supervisor's guardian: it waits until the supervisor ends, and ends as well. Where
// the supervisor does not end within 6 s after graze closed its end of `control`, the guardian kills it. Returns
// in the supervisor: process 1 of a namespace of its own, in which foreign code sees and signals only its own
// processes, has only shared memory of its own and no control groups, and which the system ends with it. Where no
// namespace can be had, returns in the calling process, as a subreaper. namespaces: whether to try. shared_bytes: of
// memory that is shared by name. read_only: a folder that cannot be written to or moved in the namespace; empty for
// none. Requires: one thread.
void enter_containment(bool namespaces, std::uint64_t shared_bytes, int control, const std::string& read_only = "");

// The descriptor that becomes readable when the process ends; -1 where there is no such process.
int open_process(pid_t process);

// Whether the process descends from the calling one. Not certain of a process that may end; see open_process.
bool is_descendant(pid_t process);

struct Usage {
  std::uint64_t processes, bytes;  // bytes of memory, shared pages counted in parts
};
// What all descendants take at this moment; counts up to `most_bytes` and `most_processes`, and a little beyond.
Usage usage_of_descendants(std::uint64_t most_bytes, std::uint64_t most_processes);

// Kills all children but one, and what they leave behind.   Returns: whether none is left.
bool end_children(pid_t except);

// From here on neither this process nor what it starts can change the limits of other processes, as those of its
// supervisor, which has the same user, or take memory that no limit counts (memfd_create).
void forbid_calls();

// Gives up the rights of root that would reach beyond the limits: tracing, mounting, lifting limits, rebooting,
// delaying the supervisor, and reaching files by handles and disks.
void drop_rights();

}  // namespace graze::subjects
