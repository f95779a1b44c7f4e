// SPDX-License-Identifier: Apache-2.0
// Runs a program that answers each line of input with one line on its standard output. An input line has a pair's 18
// coordinates as hexadecimal floats (0x1.8p+1). Answers: 0 disjoint, 1 intersects, ? declined.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

#include "subjects/channel.h"

namespace graze::subjects {

// Splits a program's output into lines. The output may be anything and may be endless.
class Lines {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 20;  // the most bytes that may be waiting

  // Throws: std::runtime_error if more than kMostBytes are waiting.
  void add(const char* bytes, std::size_t count);
  // Takes the next line, without the newline.   Returns: whether there was a whole line.
  bool take(std::string& line);
  bool empty() const { return taken_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t taken_ = 0;
};

// Throws: std::runtime_error for a line that is not an answer.
signed char answer_of_line(const std::string& line);

// A program's standard input and output. Writing to the input does not block.
struct Pipes {
  int to = -1, from = -1;
};

// Starts the program in a shell. The program ends with the calling process.   Throws: std::runtime_error.
Pipes start_program(const std::string& command);

class LineProtocol {
 public:
  explicit LineProtocol(const std::string& command) : pipes_(start_program(command)) {}

  // Asks about the question's pairs, forward and then backward. Writes each answer into `words` when it arrives. After
  // the last answer, waits 2 ms for unexpected output.
  // Throws: std::runtime_error when the program ends, gives an invalid answer, or writes unexpected output.
  void ask(const Question& question, const float* pairs, std::uint64_t* words);

 private:
  void send(const std::string& lines);
  void read_some();
  std::string line();  // waits for a line
  // Throws: std::runtime_error if there is unexpected output now or within this time.
  void expect_silence(int milliseconds);

  Pipes pipes_;
  Lines lines_;
};

// The first line of the program's answer to `describe`. Empty when the program ends without an answer; kNoAnswer if it
// gives none in time and does not end; kLongAnswer if the answer does not fit into Loaded.
inline constexpr const char* kNoAnswer = "?no answer within 10 s";
inline constexpr const char* kLongAnswer = "?an answer of 8 KiB or more";
std::string described_by(const std::string& command);

}  // namespace graze::subjects
