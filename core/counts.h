// SPDX-License-Identifier: Apache-2.0
// Counts of verdicts that differ from the truth, by kind. All code that counts errors uses this definition of "wrong".
#pragma once

#include <cstdint>

#include "core/verdict.h"

namespace graze {

// A declined verdict is not wrong: it is counted separately and never added to the wrong verdicts.
constexpr bool is_wrong(Verdict verdict, Verdict truth) { return verdict != truth && verdict != Verdict::declined; }

struct Counts {
  std::uint64_t false_positive = 0;
  std::uint64_t false_negative = 0;
  std::uint64_t declined = 0;
  std::uint64_t crashed = 0, timed_out = 0, unstable = 0;  // only for foreign code
  std::uint64_t by_convention = 0;                         // not the truth, but allowed by the lane's convention

  constexpr std::uint64_t failed() const { return crashed + timed_out + unstable; }
  constexpr std::uint64_t wrong() const { return false_positive + false_negative + failed(); }
  constexpr std::uint64_t not_right() const { return wrong() + declined; }  // wrong or declined
  // Not the truth, wrong or not. Lanes are ranked by it, so that neither a lane that declines nor one that a
  // convention excuses ranks above a lane that is right.
  constexpr std::uint64_t not_true() const { return not_right() + by_convention; }
  constexpr bool any_foreign() const { return failed() != 0 || by_convention != 0; }

  // The count for a verdict that differs from the truth.
  constexpr std::uint64_t& of(Verdict verdict) {
    switch (verdict) {
      case Verdict::intersects:
        return false_positive;
      case Verdict::disjoint:
        return false_negative;
      case Verdict::declined:
        return declined;
      case Verdict::crashed:
        return crashed;
      case Verdict::timed_out:
        return timed_out;
      case Verdict::unstable:
        break;
    }
    return unstable;
  }

  constexpr Counts& operator+=(const Counts& other) {
    false_positive += other.false_positive;
    false_negative += other.false_negative;
    declined += other.declined;
    crashed += other.crashed;
    timed_out += other.timed_out;
    unstable += other.unstable;
    by_convention += other.by_convention;
    return *this;
  }
  friend constexpr bool operator==(const Counts&, const Counts&) = default;
};

}  // namespace graze
