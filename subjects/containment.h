// SPDX-License-Identifier: Apache-2.0
// Contains the processes of foreign code, so that none outlives its supervisor. They run in a process namespace of
// their own if the system allows one; otherwise the supervisor is the subreaper of its descendants.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace graze::subjects {

// The calling process becomes the supervisor's guardian: it waits until the supervisor ends, and ends as well. If the
// supervisor does not end within 6 s after graze closed its end of `control`, the guardian kills it. Returns in the
// supervisor, which is process 1 of a new namespace. There, foreign code sees and signals only its own processes, and
// has its own shared memory and no control groups. The system ends the namespace with the supervisor. If no namespace
// is possible, returns in the calling process, as a subreaper. namespaces: whether to try. shared_bytes: the limit of
// memory that is shared by name. read_only: a folder that the namespace can neither write to nor move; empty for none.
// Requires: one thread.   Returns: whether System V memory, semaphores and message queues have limits.
bool enter_containment(bool namespaces, std::uint64_t shared_bytes, int control, const std::string& read_only = "");

// A descriptor that becomes readable when the process ends; -1 when there is no such process.
int open_process(pid_t process);

// Whether the process descends from the calling one. Unreliable for a process that may end; see open_process.
bool is_descendant(pid_t process);

// Kills all children except one, and their descendants. Calls `tell_alive` again and again meanwhile.
// Returns: whether none is left.
bool end_children(pid_t except, void (*tell_alive)());

// From now on this process and its descendants cannot change the limits of other processes. (The supervisor runs as
// the same user.) They also cannot allocate memory that no limit counts (memfd_create and the like), make namespaces,
// or run programs in the kernel. system_v: whether they may make System V memory, semaphores and message queues.
void forbid_calls(bool system_v);

// Gives up all rights of root except those for files, users and low ports. The others bypass the limits: tracing,
// mounting, lifting limits, rebooting, setting the clock, delaying the supervisor, reaching files by handles and disks.
void drop_rights();

}  // namespace graze::subjects
