// SPDX-License-Identifier: Apache-2.0
// Which pairs of a block still need an answer, and which answers there are: the supervisor's side of the questions.
#pragma once

#include <span>

#include "subjects/channel.h"

namespace graze::subjects {

// Each pair is asked twice, forward and then backward, so that what one call leaves behind shows in another. Answers
// count in this order and once each: a word that is forged, early, late or of another question changes nothing.
// Answers of a program carry no number: one line too many gives each later pair another pair's answer. So those of a
// question count all or not at all, and a pair fails only when it is asked alone.
class Questions {
 public:
  // of_blocks: the subject takes many pairs at once. program: it answers by lines.
  // Requires: 0 < count <= kMostAsked.
  Questions(std::size_t count, bool of_blocks, bool program) : count_(count), singly_(!of_blocks), program_(program) {}

  // What to ask now.   Requires: a nonce that was not used before; !done().
  Question next(std::uint64_t nonce);

  // Takes the answers to the last question that are in memory, kWords words, each read once.   Returns: how many.
  std::size_t take(const std::uint64_t* words);

  // Whether the last question has all its answers.
  bool answered() const { return asked_ == taken_; }

  // The worker ended, or was ended, before that. Of a block it is asked again, one pair at a time. Otherwise the first
  // pair without an answer has this one, kCrashed or kTimedOut; but where no pair of the question has an answer, that
  // pair is asked alone first: code that destroys its own answers is at fault on a later pair. Of a program, no answer
  // to the question counts, and fewer pairs are asked.   Requires: !answered(), but of a program.
  void failed(signed char how);

  bool done() const { return second_ && at_ == 0; }

  // Every pair that has no final answer gets this one.
  void give_up(signed char how);

  std::span<const signed char> answers() const { return {answers_.data(), count_}; }

 private:
  void skip_failed();
  void advance();

  std::size_t count_;
  bool singly_, program_;
  std::size_t most_ = 2 * kMostAsked;  // answers that the next question asks for
  std::size_t asked_ = 0, taken_ = 0;  // answers, of the last question
  bool second_ = false;
  std::size_t at_ = 0;  // forward: the pair without an answer; backward: the one after it
  std::array<signed char, kMostAsked> answers_{};
  std::uint64_t nonce_ = 0;
  // What these were before the last question.
  bool second_before_ = false;
  std::size_t at_before_ = 0;
  std::array<signed char, kMostAsked> answers_before_{};
};

// Makes what a worker sent of its code fit to use: texts end and are printable, flags are 0 or 1.
// Returns: whether these bytes are such a message.
bool read_loaded(std::span<const char> bytes, Loaded& loaded);

}  // namespace graze::subjects
