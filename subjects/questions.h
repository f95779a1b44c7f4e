// SPDX-License-Identifier: Apache-2.0
// The supervisor's side of the questions about a block: the pairs that still need an answer, and the answers so far.
#pragma once

#include <span>

#include "subjects/channel.h"

namespace graze::subjects {

// Each pair is asked twice, forward and then backward, so that state left behind by one call shows in another. Answers
// are accepted only in the order of the question, and only once each. A word that is forged, early, late or for another
// question changes nothing. A program's answers are not numbered: after one extra line, each later pair would get
// another pair's answer. So either all its answers to a question count, or none. One-pair questions find the failing
// pair.
class Questions {
 public:
  // of_blocks: whether the subject takes blocks of pairs. program: whether a program answers, line by line or block by
  // block.
  // Requires: 0 < count <= kMostAsked.
  Questions(std::size_t count, bool of_blocks, bool program) : count_(count), singly_(!of_blocks), program_(program) {}

  // The next question.   Requires: a nonce that was not used before; !done().
  Question next(std::uint64_t nonce);

  // Takes the last question's answers from memory (kWords words, each read once).   Returns: the number taken.
  std::size_t take(const std::uint64_t* words);

  // Whether all answers to the last question have been taken.
  bool answered() const { return asked_ == taken_; }

  // Call this if the worker ended, or was ended, before it had answered. The next step depends on the subject:
  // - blocks: the next question is about the same pairs, one at a time.
  // - single pairs: the first pair without an answer gets `how`, kCrashed or kTimedOut. If no pair has an answer, the
  //   next question is about the first pair alone, because code that overwrites its answers may have failed later.
  // - a program: all answers to this question are discarded, and the next question has fewer pairs. If no pair of the
  //   block fails alone afterwards, the failure came from the program's state, and the pair at which the question
  //   failed gets `how`. A question fails at the first pair without an answer, or at the last pair if the program wrote
  //   extra lines.
  // Requires: !answered(), except for a program.
  void failed(signed char how);

  bool done() const { return second_ && at_ == 0; }

  // Gives `how` to every pair without a final answer.
  void give_up(signed char how);

  std::span<const signed char> answers() const { return {answers_.data(), count_}; }

 private:
  std::size_t next_pair() const { return second_ ? at_ - 1 : at_; }
  void skip_failed();
  void advance();

  std::size_t count_;
  bool singly_, program_;
  std::size_t most_ = 2 * kMostAsked;  // the most answers that the next question asks for
  std::size_t asked_ = 0, taken_ = 0;  // answers that the last question asks for; answers taken
  bool second_ = false;
  std::size_t at_ = 0;  // forward: the first pair without an answer; backward: the pair after that one
  std::array<signed char, kMostAsked> answers_{};
  std::uint64_t nonce_ = 0;
  // The state before the last question was asked.
  bool second_before_ = false;
  std::size_t at_before_ = 0;
  std::array<signed char, kMostAsked> answers_before_{};
  std::array<signed char, kMostAsked>
      failed_here_{};  // for a program: how a question failed at each pair; 0: not at all
};

// Sanitises a worker's message about its code: terminates texts, replaces control characters, and sets flags to 0 or 1.
// Returns: whether the bytes are such a message.
bool read_loaded(std::span<const char> bytes, Loaded& loaded);

}  // namespace graze::subjects
