// SPDX-License-Identifier: Apache-2.0
// A program that answers on its standard output: one line for each line on its standard input, which holds the 18
// coordinates of a pair as hexadecimal floats (0x1.8p+1). Answers: 0 disjoint, 1 intersects, ? declined.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace graze::subjects {

class LineProtocol {
 public:
  // Starts the program, by a shell.
  explicit LineProtocol(const std::string& command);

  // Asks about the pairs from `next` on, forward and then backward; `next` and `second` say where it is.
  // singly: the next line only after the answer to the last one, so that `next` is known where the program ends.
  // Throws: std::runtime_error where the program ends, or answers something else.
  void ask(bool singly, const float* pairs, std::uint64_t count, volatile std::uint64_t& next,
           volatile std::uint32_t& second, signed char* answers);

 private:
  signed char answer();  // waits for a line
  void send(const std::string& lines);

  int to_ = -1, from_ = -1;
  std::string read_;  // not yet taken
};

}  // namespace graze::subjects
