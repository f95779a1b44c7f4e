// SPDX-License-Identifier: Apache-2.0
// A block function that runs foreign code in separate processes. The code may crash, hang, corrupt memory, lie or
// attack. Each failure becomes the verdict on its pair, and a new process is asked about the next pair. This process
// trusts only the supervisor (supervisor.h), and talks to it over a socket that foreign code does not have.
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

// The code that graze-subject-host loads; the first lines of host.cpp explain the fields.
struct Code {
  std::string kind;             // "library", "program", "command" or "device"
  std::string what, name;       // a file and its symbol, a command, the command that runs a program, or a PTX file
  std::string scalar = "any";   // for a function without a description
  double timeout = 1;           // seconds for a pair, or for a block of a subject that takes blocks
  std::uint64_t memory = 1024;  // MiB for all processes of the code together
  bool namespaces = true;       // run in a process namespace if the system allows one
  bool alone = false;           // one process at a time, because several would wait for one device
  std::shared_ptr<const SealedCopy> content = nullptr;  // the bytes to load; null: those of the file
  std::vector<HashedFile> files = {};                   // a command's files; `decide` throws if one of them changes
};

// A subject's description of itself.
struct Description {
  bool f32 = false, f64 = false;
  unsigned outside = 0;  // a sum of Outside
  std::string version, source, convention;
  bool describes_itself = false;  // has a struct graze_subject
  std::string symbol;             // a library's symbol that was loaded
  std::string said;               // the first line of a program's answer to `describe`
  bool of_blocks = false;         // decides many pairs in one call

  bool has(Scalar scalar) const { return scalar == Scalar::f32 ? f32 : f64; }
};

// Loads the code, and asks it to describe itself.   Throws: std::runtime_error with one line if the code cannot be
// loaded; Stopped.
Description describe(const Code& code);

class HostProcess;

// Decides blocks with foreign code, using one supervisor for each thread that calls at the same time. Thread-safe.
class ForeignProcesses : public ForeignCode {
 public:
  ForeignProcesses(Code code, Scalar scalar);
  ~ForeignProcesses() override;
  // Throws: Stopped, at most 0.1 s after the request to stop; std::runtime_error if a file of a command has changed
  // since it was read.
  void decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) override;
  void decide_doubles(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects,
                      std::uint64_t* declined) override;
  Verdict failure(const Pair& pair) override;
  Verdict failure_on_doubles(const DoublePair& pair) override;
  bool decides_doubles() const override { return scalar_ == Scalar::f64; }

  // The processor time that the code took for one pass over the pairs of the last call. The code's own process measures
  // this time, without communication. Empty for a command, or if the code failed on a pair.
  std::optional<std::uint64_t> nanoseconds() const;
  // The same code, in new processes that have seen no pair.
  std::unique_ptr<ForeignProcesses> anew() const;
  // The descriptor of the code that new processes load; -1 for a command.
  int content() const;

 private:
  std::unique_ptr<HostProcess> idle_or_new();
  template <class AnyPair>
  void decide_all(const AnyPair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined);
  template <class AnyPair>
  Verdict failure_of(const AnyPair& pair);

  Code code_;
  Scalar scalar_;
  mutable std::mutex mutex_;
  std::mutex alone_;
  std::optional<std::uint64_t> nanoseconds_;
  std::vector<std::unique_ptr<HostProcess>> idle_;
  std::map<std::string, Verdict> failures_;  // by the pair's bytes; incomplete: missing pairs are asked again
};

}  // namespace graze::subjects
