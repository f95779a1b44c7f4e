// SPDX-License-Identifier: Apache-2.0
// A program that answers on its standard output: one line for each line on its standard input, which holds the 18
// coordinates of a pair as hexadecimal floats (0x1.8p+1). Answers: 0 disjoint, 1 intersects, ? declined.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

#include "subjects/channel.h"

namespace graze::subjects {

// The lines of what a program writes, which may be anything and without end.
class Lines {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 20;  // not yet taken

  // Throws: std::runtime_error beyond kMostBytes.
  void add(const char* bytes, std::size_t count);
  // Returns: whether a whole line was there; without its end.
  bool take(std::string& line);
  bool empty() const { return taken_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t taken_ = 0;
};

// Throws: std::runtime_error for a line that is no answer.
signed char answer_of_line(const std::string& line);

class LineProtocol {
 public:
  // Starts the program, by a shell.
  explicit LineProtocol(const std::string& command);

  // Asks about the question's pairs, forward and then backward, and writes each answer into memory when it comes.
  // Then waits 2 ms, whether more comes.
  // Throws: std::runtime_error where the program ends, answers something else, or writes what was not asked for.
  void ask(const Question& question, const float* pairs, std::uint64_t* words);

  // Returns: the first line that it writes in answer to this line, after which its input ends; empty where it ends
  // without one, writes more than fits in Loaded, or takes longer.
  std::string first_line(const std::string& in_answer_to, double seconds);

 private:
  void send(const std::string& lines);
  void read_some();
  std::string line();  // waits for it
  // Throws: std::runtime_error where there is output that was not asked for, or comes in this time.
  void expect_silence(int milliseconds);

  int to_ = -1, from_ = -1;
  Lines lines_;
};

// What a program says in answer to `describe`.
std::string described_by(const std::string& command);

}  // namespace graze::subjects
