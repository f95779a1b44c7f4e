// SPDX-License-Identifier: Apache-2.0
// Reads the answers of a program that a toolchain built from a subject (graze/program.h). The program answers block by
// block on its standard output.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "subjects/channel.h"
#include "subjects/line_protocol.h"

namespace graze::subjects {

class ProgramProtocol {
 public:
  // Starts the program in a shell and waits for its greeting.
  // Throws: std::runtime_error if no greeting comes within `seconds`, or if the output is not a greeting.
  ProgramProtocol(const std::string& command, double seconds);

  ~ProgramProtocol();  // closes the program's input, which ends the program
  ProgramProtocol(const ProgramProtocol&) = delete;
  ProgramProtocol& operator=(const ProgramProtocol&) = delete;

  bool has_f32() const { return has_ & 1; }
  bool has_f64() const { return has_ & 2; }

  // Asks about the question's pairs, forward and then backward. Writes the answers into `words` once all have arrived.
  // The supervisor checks the answers.
  // Throws: std::runtime_error if the program ends.
  void ask(const Question& question, const void* pairs, bool in_double, std::uint64_t* words);

 private:
  // Writes `bytes` and reads `count` bytes at the same time, so that a full pipe causes no deadlock.
  void exchange(const std::vector<char>& bytes, void* answer, std::size_t count, double seconds);

  Pipes pipes_;
  std::uint32_t has_ = 0;
};

}  // namespace graze::subjects
