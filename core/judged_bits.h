// SPDX-License-Identifier: Apache-2.0
// Compares a lane's verdicts on a word of pairs with the truth. All code, on host and device, derives errors from
// verdict bits here.
#pragma once

#include "core/exact/host_device.h"

namespace graze {

// Bit i belongs to pair i of the word. For each pair, at most one of these words has the pair's bit set.
template <class Word>
struct JudgedBits {
  Word false_positive, false_negative;
  Word declined;
  Word failed;  // foreign code crashed, timed out or was unstable

  GRAZE_HD constexpr Word wrong() const { return false_positive | false_negative | failed; }
  GRAZE_HD constexpr Word not_right() const { return wrong() | declined; }
};

// intersects, declined: the lane's words, as DecideBlock writes them. truth: the pairs that intersect. judged: the
// pairs to count. foreign: if both bits of a pair are set, the lane's code failed on it.
template <class Word>
GRAZE_HD constexpr JudgedBits<Word> judge(Word intersects, Word declined, Word truth, Word judged,
                                          bool foreign = false) {
  const Word answered = judged & ~declined, failed = foreign ? judged & declined & intersects : Word{0};
  return {answered & intersects & ~truth, answered & ~intersects & truth, judged & declined & ~failed, failed};
}

}  // namespace graze
