// SPDX-License-Identifier: Apache-2.0
// Why foreign code is wrong on a pair. It has no steps to look at, so its verdicts on other pairs, and those of its
// other builds, are all that there is: experiments.
#pragma once

#include "analysis/explain.h"

namespace graze::analysis {

// The first that holds; nothing else is claimed of it than what the experiment shows:
//   crash, no answer in time, unstable   the verdict says so itself
//   contraction, fast math   the same code with every operation rounded as written is right, at all scales and in
//                float64 too: no luck, of code that is wrong in exact arithmetic as well
//   absolute epsilon   the verdict changes with the pair's scale, once and for the better upwards, though no product of
//                up to kMostFactors coordinates leaves the scalar's exponents. Scaling by a power of two changes
//                nothing else in an algorithm whose numbers keep their units; code that adds lengths and areas turns
//                more often
//   underflow, overflow   right at all scales at which no product of kUsualFactors leaves the exponents, and the pair
//                is below or above these
//   rounding     right in float64 at every scale, and wrong in float32 at each that leaves no exponents
//   degenerate input, order-dependent, logic   the coordinates have so few bits that no sum and no product of up to
//                kUsualFactors differences rounds
// Where none of them can be shown: rounding where some image of the pair is right, order-dependent where only other
// orders are, else degenerate input or logic; never settled.
inline constexpr int kUsualFactors = 6;  // the product of two determinants
inline constexpr int kMostFactors = 14;  // Moller 1997 without division has 13

struct Experiment {
  Cause cause;
  bool settled;
  std::string evidence;  // "scaled by 2^10 it is right, by 2^9 wrong, …"
  bool slow = false;     // it took all of its time on some pairs, and the others were not asked
};

// Deterministic, of deterministic code. Asks for at most some 230 verdicts.
// Requires: a foreign lane whose verdict on the pair is not the truth; finite coordinates.
Experiment experiment(const Lane& lane, Verdict verdict, const Pair& pair, Verdict truth);

}  // namespace graze::analysis
