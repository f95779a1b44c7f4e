// SPDX-License-Identifier: Apache-2.0
// Programs that build something for graze, as a compiler does. None outlives graze, whatever ends it: each runs under a
// supervisor, with all that it starts, in a process namespace of its own where the system allows one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace graze {

// A new folder for files on their way, removed with its owner. Removes those whose owner was killed: nobody holds their
// lock. Where the file system has no locks, those of a day ago.
class Scratch {
 public:
  explicit Scratch(const std::filesystem::path& within);
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

struct Program {
  std::vector<std::string> words;  // without a shell
  double seconds = 1800;           // for which it may run
  bool namespaces = true;          // whether to try one
};

// Runs the program, whose temporary files are in `scratch`, a folder. Where graze is killed, the supervisor removes it.
// Returns: the exit status, or 128 and the signal, as a shell does; 127 where there is no such program.
// output: what it wrote to both streams.   Throws: Stopped; std::runtime_error where it takes too long.
int run_program(const Program& program, const std::filesystem::path& scratch, std::string& output);

}  // namespace graze
