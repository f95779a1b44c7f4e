// SPDX-License-Identifier: Apache-2.0
// Explains why foreign code is wrong on a pair. Its steps are not visible, so the only evidence is its verdicts on
// other pairs, and the verdicts of other builds of its source: experiments.
#pragma once

#include "analysis/explain.h"

namespace graze::analysis {

// The first cause whose condition holds. Nothing beyond the experiment's result is claimed.
//   crash, no answer in time, unstable   the verdict itself says so
//   contraction, fast math   the same code with every operation rounded as written is right, at all scales and in
//                float64 too. This rules out code that is wrong in exact arithmetic and right here by luck.
//   contraction, excess precision, fast math, of a toolchain's lane   the same code compiled with the toolchain's
//   strict
//                flags is right, likewise. If one line of fused products, rounded alone, makes it right, that is its
//                line
//   absolute epsilon   the verdict changes with the pair's scale: once, and from wrong to right as the scale grows. No
//                product of up to kMostFactors coordinates leaves the scalar's exponents at these scales. Scaling by a
//                power of two changes nothing else in an algorithm whose units are consistent; code that adds lengths
//                and areas changes its verdict more often. Or: with another number in place of small ones in its
//                source it is right (subjects/rebuilt.h), also on those of up to kMostImages orders and mirror images
//                of the pair on which it was wrong, and on the pair with 1e-9 of the number, as code that multiplies by
//                a unit is right with 1e-36 where its products underflow; and it is right at some larger scale at
//                which no product of kUsualFactors leaves the exponents
//   relative epsilon   the same, but it is wrong at every larger scale
//   uninitialised   its verdict depends on the value that the compiler gives to variables without a value; or any such
//                value makes it right, the compiler warns of such a variable, and the coordinates are small integers,
//                times a power of two, so that other machine code hardly rounds otherwise
//   underflow, overflow   right at all scales at which no product of kUsualFactors leaves the exponents, and the pair
//                is smaller or larger than these scales allow. Of doubles this is not settled: nothing wider can show
//                that code which adds lengths and areas is right there without limits
//   degenerate input, order-dependent, logic   the coordinates are small integers, times a power of two. It is wrong
//                at all larger scales, where an absolute epsilon vanishes, and in float64 if it has that. Then no
//                product of up to kMostFactors differences rounds; or only longer ones than kUsualFactors do, and it is
//                wrong in the same ones of the pair's 72 orders when they change. Logic is wrong in all orders
//   rounding     right in float64 at every scale, and wrong in float32 at every scale within the exponents. Where the
//                code has no function of doubles, its source with double in place of float is that
// If no cause can be shown, the result is not settled. It is an epsilon if negligible numbers and double in place of
// float, together, make it right; a relative one if in doubles it is wrong at all larger scales. Else it is
// order-dependent if only other orders are right, rounding if some other image of the pair is right, and degenerate
// input or logic otherwise. But where products of three differences round, it is not logic unless the code is wrong in
// doubles too; and it is not rounding where it is wrong in doubles that hold such products. Where the source has no
// small number, a verdict that changes with the scale is underflow or overflow. The evidence then names two experiments
// that would settle it.
inline constexpr int kUsualFactors = 6;  // the product of two determinants
inline constexpr int kMostFactors = 14;  // Moller 1997 without division has 13

inline constexpr int kMostImages = 24;
// Verdicts that one experiment asks for, those of changed builds included. At most 7 changes of numbers take
// 78 + 7 * (2 + kMostImages) = 260 of them, orders of small integers and their images 662, other
// images 96, and scales less than 240.
inline constexpr int kMostAsked = 1260;

struct Experiment {
  Cause cause;
  bool settled;
  std::string evidence;   // "scaled by 2^10 it is right, by 2^9 wrong, …"
  std::string line = {};  // "mine.cpp:9", of the number that decides; empty if it is not known
  bool slow = false;      // some pairs timed out, so the remaining ones were not tried
  int asked = 0;          // verdicts
};

// Deterministic if the code is. Asks for at most kMostAsked verdicts. A changed build takes about a second, once in a
// process.
// Requires: a foreign lane whose verdict on the pair is not the truth; finite coordinates.
template <class Real>
Experiment experiment(const Lane& lane, Verdict verdict, const BasicPair<Real>& pair, Verdict truth);

}  // namespace graze::analysis
