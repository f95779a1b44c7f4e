// SPDX-License-Identifier: Apache-2.0
// The supervisor's side of the questions: which pairs of a block still need an answer, and the answers so far.
#pragma once

#include <span>

#include "subjects/channel.h"

namespace graze::subjects {

// Each pair is asked twice, forward and then backward, so that state left behind by one call shows in another. Answers
// are accepted only in this order, and only once each. A word that is forged, early, late or for another question
// changes nothing. A program's answers have no numbers: one extra line would give each later pair the answer of another
// pair. So a question's answers count all or not at all, and the pair that makes it fail is found by asking it alone.
class Questions {
 public:
  // of_blocks: the subject takes blocks of pairs. program: a program answers, by lines or block by block.
  // Requires: 0 < count <= kMostAsked.
  Questions(std::size_t count, bool of_blocks, bool program) : count_(count), singly_(!of_blocks), program_(program) {}

  // The next question.   Requires: a nonce that was not used before; !done().
  Question next(std::uint64_t nonce);

  // Takes the last question's answers from memory (kWords words, each read once).   Returns: how many.
  std::size_t take(const std::uint64_t* words);

  // Whether all answers to the last question are there.
  bool answered() const { return asked_ == taken_; }

  // The worker ended, or was ended, before the question was answered. What happens depends on the subject:
  // - blocks: asks the block again, one pair at a time.
  // - single pairs: the first pair without an answer gets `how`, kCrashed or kTimedOut. If no pair has an answer, it
  //   first asks that pair alone, because code that destroys its own answers fails on a later pair.
  // - a program: all answers to this question are discarded, and the next question has fewer pairs. If no pair of the
  //   block fails alone afterwards, the failure came from the program's state. Then the pair at which it failed gets
  //   `how`: the first one without an answer, or the last one if the program wrote more than it was asked for.
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
  std::size_t most_ = 2 * kMostAsked;  // most answers that the next question asks for
  std::size_t asked_ = 0, taken_ = 0;  // numbers of answers, for the last question
  bool second_ = false;
  std::size_t at_ = 0;  // forward: the first pair without an answer; backward: the one after it
  std::array<signed char, kMostAsked> answers_{};
  std::uint64_t nonce_ = 0;
  // The answers before the last question.
  bool second_before_ = false;
  std::size_t at_before_ = 0;
  std::array<signed char, kMostAsked> answers_before_{};
  std::array<signed char, kMostAsked> failed_here_{};  // for a program: how a question failed at this pair; 0: none did
};

// Sanitises a worker's message about its code: terminates texts, makes them printable, and sets flags to 0 or 1.
// Returns: whether the bytes are such a message.
bool read_loaded(std::span<const char> bytes, Loaded& loaded);

}  // namespace graze::subjects
