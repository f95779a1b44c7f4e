// SPDX-License-Identifier: Apache-2.0
// Foreign code in processes of its own, as a lane's block function. It may crash, hang, scribble, lie or attack: each
// is a verdict on the pair on which it happens, and the next pair is asked in a new process. What this process believes
// comes from a supervisor (supervisor.h) over a socket that foreign code does not have.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "subjects/code_hash.h"
#include "subjects/sealed_copy.h"

namespace graze::subjects {

// What graze-subject-host loads; see its first lines.
struct Code {
  std::string kind;             // "library", "command" or "device"
  std::string what, name;       // file and export, or the command, or a file of PTX
  std::string scalar = "any";   // of a function without description
  double timeout = 1;           // seconds for a pair, or for a block of a subject that takes blocks
  std::uint64_t memory = 1024;  // MiB, of all its processes together
  bool namespaces = true;       // in a process namespace of its own, where the system allows one
  std::shared_ptr<const SealedCopy> content = nullptr;  // of the file: what is loaded; taken from it where empty
  std::vector<HashedFile> files = {};                   // of a command: it ends where one of them changes
};

// What a subject says of itself.
struct Description {
  bool f32 = false, f64 = false;
  unsigned outside = 0;  // a sum of Outside
  std::string version, source, convention;
  bool describes_itself = false;  // by a struct graze_subject
  std::string symbol;             // of a library, that was taken
  std::string said;               // by a program, in answer to `describe`: its first line
};

// Throws: std::runtime_error, in one line, where the code cannot be loaded; Stopped.
Description describe(const Code& code);

class HostProcess;

// One process for each thread that asks at once. Thread-safe.
class ForeignProcesses : public ForeignCode {
 public:
  ForeignProcesses(Code code, Scalar scalar);
  ~ForeignProcesses() override;
  // Throws: Stopped, within a tenth of a second of the request, whatever the code does; std::runtime_error where a
  // command's files have changed.
  void decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) override;
  Verdict failure(const Pair& pair) override;

  // What the code itself took for the pairs of the last decide, asked once: processor time in its own process, without
  // what the processes say to each other. Nothing where it failed on one of them, and of a command.
  std::optional<std::uint64_t> nanoseconds() const;
  // The same code, in processes that have seen no pair yet.
  std::unique_ptr<ForeignProcesses> anew() const;

 private:
  std::unique_ptr<HostProcess> idle_or_new();

  Code code_;
  Scalar scalar_;
  mutable std::mutex mutex_;
  std::mutex alone_;
  std::optional<std::uint64_t> nanoseconds_;
  std::vector<std::unique_ptr<HostProcess>> idle_;
  std::map<std::string, Verdict> failures_;  // by the pair's bytes; some of them, the others are asked again
};

}  // namespace graze::subjects
