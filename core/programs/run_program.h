// SPDX-License-Identifier: Apache-2.0
// Runs programs that build something for graze, such as a compiler. No program outlives graze, even if graze is killed:
// a supervisor runs each program and all its children, in a separate process namespace if the system allows it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace graze {

// A new folder for unfinished files; the destructor removes it. The constructor also removes folders whose owners
// were killed: those without a lock, or, on a file system without locks, those older than a day.
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

// The program's file, found on the PATH as a shell finds it; empty if there is none. An empty PATH entry means the
// current folder.
std::filesystem::path on_path(const std::string& program);

struct Program {
  std::vector<std::string> words;  // run without a shell
  double seconds = 1800;           // time limit
  bool namespaces = true;          // whether to use a process namespace if the system allows it
  std::uint64_t mib = 8192;        // memory limit of all its processes together
};

// Runs the program with `scratch` for its temporary files. If graze is killed, the supervisor removes `scratch`.
// Returns: the exit status, or 128 plus the signal, as a shell does; 127 if there is no such program.
// output: the text that it wrote to both streams.   Throws: Stopped; std::runtime_error if it takes too long or too
// much memory. The program may write files of up to 1 GiB each.
int run_program(const Program& program, const std::filesystem::path& scratch, std::string& output);

// Runs the command in a shell, like run_program.   Returns: its output; its exit status in `status`.
std::string shell_output(const std::string& command, const std::filesystem::path& scratch, int& status,
                         double seconds = Program().seconds);

}  // namespace graze
