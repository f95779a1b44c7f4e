// SPDX-License-Identifier: Apache-2.0
// Contains the processes of foreign code, so that none outlives its supervisor. The processes run in their own process
// namespace if the system allows one; otherwise the supervisor is their subreaper.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace graze::subjects {

// Starts the supervisor as process 1 of a new process namespace, and returns in the supervisor. In the namespace,
// foreign code sees and signals only its own processes, and has its own shared memory and no control groups. When the
// supervisor ends, the system ends the namespace. The calling process becomes the supervisor's guardian, and exits
// after the supervisor. The guardian kills a supervisor that still runs 6 s after graze closed its end of `control`. If
// no namespace is possible, returns in the calling process, as a subreaper. namespaces: whether to try a namespace.
// shared_bytes: the limit for named shared memory. read_only: a folder that code in the namespace can neither write to
// nor move; empty for none. Requires: one thread.   Returns: whether System V memory, semaphores and message queues
// have limits.
bool enter_containment(bool namespaces, std::uint64_t shared_bytes, int control, const std::string& read_only = "");

// A descriptor that becomes readable when the process ends; -1 if there is no such process.
int open_process(pid_t process);

// Whether the process descends from the calling process. If the process may end, the answer is reliable only while a
// descriptor from open_process is open.
bool is_descendant(pid_t process);

// Kills all children except the child `except`, with their descendants. Meanwhile, calls `tell_alive` repeatedly.
// Returns: whether no other child is left.
bool end_children(pid_t except, void (*tell_alive)());

// Permanently prevents this process and its descendants from making some system calls. They can then no longer change
// the limits of other processes, such as the supervisor, which runs as the same user. They also cannot allocate memory
// that no limit counts (memfd_create and similar calls), make namespaces, or run programs in the kernel. system_v:
// whether they may make System V memory, semaphores and message queues.
void forbid_calls(bool system_v);

// Drops root's capabilities except those for files, users and low ports. The dropped ones would bypass the limits:
// tracing, mounting, raising limits, rebooting, setting the clock, delaying the supervisor, and reaching files through
// handles or disks.
void drop_rights();

}  // namespace graze::subjects
