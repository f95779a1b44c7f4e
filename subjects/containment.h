// SPDX-License-Identifier: Apache-2.0
// Contains the processes of foreign code, so that none outlives its supervisor. The processes run in a process
// namespace of their own if the system allows one. Otherwise the supervisor is the subreaper of its descendants.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace graze::subjects {

// Makes the supervisor process 1 of a new process namespace, and returns in the supervisor. In the namespace, foreign
// code sees and signals only its own processes, and has its own shared memory and no control groups. The system ends
// the namespace with the supervisor. The calling process becomes the supervisor's guardian, and exits after the
// supervisor has ended. The guardian kills a supervisor that still runs 6 s after graze closed its end of `control`. If
// no namespace is possible, returns in the calling process, as a subreaper. namespaces: whether to try a namespace.
// shared_bytes: the limit of memory that is shared by name. read_only: a folder that code in the namespace can neither
// write to nor move; empty for none. Requires: one thread.   Returns: whether System V memory, semaphores and message
// queues have limits.
bool enter_containment(bool namespaces, std::uint64_t shared_bytes, int control, const std::string& read_only = "");

// A descriptor that becomes readable when the process ends; -1 when there is no such process.
int open_process(pid_t process);

// Whether the process descends from the calling process. The answer is unreliable for a process that may end, unless a
// descriptor of open_process is open.
bool is_descendant(pid_t process);

// Kills all children but `except`, with their descendants. Calls `tell_alive` repeatedly meanwhile.
// Returns: whether no child is left, except that one.
bool end_children(pid_t except, void (*tell_alive)());

// Forbids some system calls to this process and its descendants, for ever. These processes cannot change the limits of
// other processes, such as the supervisor, which runs as the same user. The processes also cannot allocate memory that
// no limit counts (memfd_create and similar calls), make namespaces, or run programs in the kernel. system_v: whether
// they may make System V memory, semaphores and message queues.
void forbid_calls(bool system_v);

// Drops root's capabilities except those for files, users and low ports. The other capabilities bypass the limits:
// tracing, mounting, lifting limits, rebooting, setting the clock, delaying the supervisor, and reaching files by
// handles and disks.
void drop_rights();

}  // namespace graze::subjects
