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
//   contraction, excess precision, fast math, of a toolchain's lane   the same holds for the code compiled with the
//                toolchain's strict flags. If rounding the fused products of one line alone makes the code right, that
//                line is named
//   absolute epsilon   the verdict changes with the pair's scale: once, and from wrong to right as the scale grows. No
//                product of up to kMostFactors coordinates leaves the scalar's exponents at these scales. Scaling by a
//                power of two changes nothing else in an algorithm whose units are consistent; code that adds lengths
//                and areas changes its verdict more often. Or: the code is right with a negligible number in place of
//                small ones in its source (subjects/rebuilt.h). It must then also be right on those of up to
//                kMostImages orders and mirror images of the pair on which it was wrong. It must be right with 1e-9
//                times the number too: code that multiplies by a unit may be right with 1e-36 because products
//                underflow. And the unchanged code must be right at some larger scale at which no product of
//                kUsualFactors leaves the exponents
//   relative epsilon   the same, but the unchanged code is wrong at every larger scale
//   uninitialised   the verdict depends on the value that the compiler gives to uninitialised variables. Or: any such
//                value makes it right, the compiler warns of such a variable, and the coordinates are small integers
//                times a power of two, so that different machine code hardly rounds differently
//   underflow, overflow   right at all scales at which no product of kUsualFactors leaves the exponents, and the pair
//                is smaller or larger than these scales allow. For doubles this is not settled: code that adds lengths
//                and areas may be wrong there even without limits, and no wider type can rule that out
//   degenerate input, order-dependent, logic   the coordinates are small integers times a power of two. The code is
//                wrong at all larger scales, where an absolute epsilon vanishes, and in doubles if it can be built so.
//                Either no product of up to kMostFactors differences rounds. Or only products of more than
//                kUsualFactors do, and when these change, the code stays wrong in the same ones of the pair's 72
//                orders. Logic is wrong in all orders
//   rounding     right in float64 at every scale, and wrong in float32 at every scale within the exponents. If the code
//                has no function of doubles, its source with double in place of float serves as one
// If no cause can be shown, the result is not settled. The cause is then given as an epsilon if negligible numbers and
// double in place of float, together, make the code right; as a relative one if it is wrong in doubles at all larger
// scales. Otherwise it is order-dependent if only other orders are right, rounding if some other image of the pair is
// right, and degenerate input or logic if none is. Where products of three differences are rounded, the cause is logic
// only if the code is wrong in doubles too; if doubles hold these products and the code is wrong in them, it is not
// rounding. If the source has no small number, a verdict that changes with the scale is underflow or overflow. The
// evidence names two experiments that would settle the cause.
inline constexpr int kUsualFactors = 6;  // the product of two determinants
inline constexpr int kMostFactors = 14;  // Moller 1997 without division has 13

inline constexpr int kMostImages = 24;
// The most verdicts that one experiment asks for, including those of changed builds. At most 7 changes of numbers take
// 78 + 7 * (2 + kMostImages) = 260 of them, orders of small integers and their images 662, other images 96, and scales
// less than 240.
inline constexpr int kMostAsked = 1260;

struct Experiment {
  Cause cause;
  bool settled;
  std::string evidence;   // "scaled by 2^10 it is right, by 2^9 wrong, …"
  std::string line = {};  // "mine.cpp:9", the line that decides; empty if it is not known
  bool slow = false;      // some pairs timed out, so the remaining ones were not tried
  int asked = 0;          // number of verdicts asked for
};

// Deterministic if the code is. Asks for at most kMostAsked verdicts. A changed build takes about a second, once per
// process.
// Requires: a foreign lane whose verdict on the pair is not the truth; finite coordinates.
template <class Real>
Experiment experiment(const Lane& lane, Verdict verdict, const BasicPair<Real>& pair, Verdict truth);

// The same, but for a lane in the lane table it returns the result that this process already has for the pair. An
// experiment takes hundreds of verdicts, and a program may need a millisecond for each.   Thread-safe.
Experiment known_experiment(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth);

}  // namespace graze::analysis
