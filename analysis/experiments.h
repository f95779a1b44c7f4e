// SPDX-License-Identifier: Apache-2.0
// Explains why foreign code is wrong on a pair. Its steps are not visible, so the only evidence is its verdicts on
// other pairs and the verdicts of its other builds: experiments.
#pragma once

#include "analysis/explain.h"

namespace graze::analysis {

// The first cause whose condition holds. Nothing beyond the experiment's result is claimed.
//   crash, no answer in time, unstable   the verdict itself says so
//   contraction, fast math   the same code with every operation rounded as written is right, at all scales and in
//                float64 too. This rules out code that is wrong in exact arithmetic and right here by luck.
//   absolute epsilon   the verdict changes with the pair's scale: once, and from wrong to right as the scale grows. No
//                product of up to kMostFactors coordinates leaves the scalar's exponents at these scales. Scaling by a
//                power of two changes nothing else in an algorithm whose units are consistent; code that adds lengths
//                and areas changes its verdict more often
//   underflow, overflow   right at all scales at which no product of kUsualFactors leaves the exponents, and the pair
//                is smaller or larger than these scales allow
//   rounding     right in float64 at every scale, and wrong in float32 at every scale within the exponents
//   degenerate input, order-dependent, logic   the coordinates have so few bits that no sum and no product of up to
//                kUsualFactors differences rounds
// If no cause can be shown, the result is not settled. It is rounding if some image of the pair is right,
// order-dependent if only other orders are right, and degenerate input or logic otherwise.
inline constexpr int kUsualFactors = 6;  // the product of two determinants
inline constexpr int kMostFactors = 14;  // Moller 1997 without division has 13

struct Experiment {
  Cause cause;
  bool settled;
  std::string evidence;  // "scaled by 2^10 it is right, by 2^9 wrong, …"
  bool slow = false;     // some pairs timed out, so the remaining ones were not tried
};

// Deterministic if the code is. Asks for at most about 230 verdicts.
// Requires: a foreign lane whose verdict on the pair is not the truth; finite coordinates.
Experiment experiment(const Lane& lane, Verdict verdict, const Pair& pair, Verdict truth);

}  // namespace graze::analysis
