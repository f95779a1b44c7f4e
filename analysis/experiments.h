// SPDX-License-Identifier: Apache-2.0
// Explains why foreign code is wrong on a pair. The code's steps are not visible, so the evidence comes from
// experiments: the code's verdicts on other pairs, and the verdicts of other builds of its source.
#pragma once

#include "analysis/explain.h"

namespace graze::analysis {

// The result is the first cause in this list whose condition holds. It claims no more than the experiments show.
//   crash, no answer in time, unstable   the verdict itself shows the cause
//   contraction, fast math   the same code with every operation rounded as written is right, at all scales and in
//                float64 too. This rules out code that is wrong in exact arithmetic and right here by luck.
//                Contraction also requires a fused product in the machine code. Here and below, another build settles
//                nothing if the source selects code by the build (subjects::selects_by_build) or if the verdict depends
//                on uninitialised variables.
//   contraction, excess precision, fast math, for a toolchain's lane   the same holds for the code compiled with the
//                toolchain's strict flags. If rounding only the fused products of one line makes the code right, that
//                line is named.
//   absolute epsilon   the verdict changes with the pair's scale: once, and from wrong to right as the scale grows. No
//                product of up to kMostFactors coordinates leaves the exponent range at these scales. Scaling by a
//                power of two changes nothing else in an algorithm whose units are consistent. Code that adds lengths
//                and areas changes its verdict more often.
//                The cause is also an absolute epsilon if the code is right with a negligible number in place of small
//                numbers in its source (subjects/rebuilt.h). The changed code must also be right on up to kMostImages
//                orders and mirror images of the pair on which the code was wrong. It must also be right with 1e-9
//                times the number, because code that multiplies by a conversion factor may be right with 1e-36 if
//                products underflow. The unchanged code must be right at some larger scale at which no product of
//                kUsualFactors leaves the exponent range.
//   relative epsilon   a small number decides in the same way, but the unchanged code is wrong at all larger scales,
//                as far as they were tried, even where products leave the exponent range.
//   uninitialised   the verdict depends on the value that the compiler gives to uninitialised variables. This is also
//                the cause if any value makes the verdict right and the compiler warns about such a variable; the
//                coordinates must then be small integers times a power of two, so that different machine code hardly
//                rounds differently.
//   underflow, overflow   the code is right at all scales at which no product of kUsualFactors leaves the exponent
//                range, and the pair is smaller or larger than these scales allow. This is not settled for doubles,
//                which have no wider type: code that adds lengths and areas may be wrong even without exponent limits.
//   degenerate input, order-dependent, logic   the coordinates are small integers times a power of two. The code is
//                wrong at all larger scales, where an absolute epsilon vanishes, and in doubles if it can be built so.
//                No product of up to kMostFactors differences rounds, or only products of more than kUsualFactors
//                round. In the latter case, images that change these longer products must not change in which of the
//                pair's 72 orders the code is wrong. For logic, the code is wrong in all orders.
//   rounding     the code is right in float64 at every scale, and wrong in float32 at every scale in the exponent
//                range. If it has no function of doubles, its source with double in place of float serves as one.
// A declined verdict is not right, so it counts as wrong here, and nothing is settled if there is one.
// If no cause can be shown, the result is not settled, and the cause is a guess. The guess is an epsilon if negligible
// numbers and double in place of float together make the code right: a relative epsilon if the code is wrong in doubles
// at all larger scales. Otherwise the guess depends on the pair's images: order-dependent if the code is right only on
// other orders, rounding if it is right on another image, and degenerate input or logic if it is right on none. If
// products of three differences round, the guess is logic only if the code is wrong in doubles too. If the code is
// wrong in doubles, which hold these products, the guess is not rounding. If the source has no small number, and the
// verdict changes with the scale, the guess is underflow or overflow. The evidence names two experiments that would
// settle the cause.
inline constexpr int kUsualFactors = 6;  // the product of two determinants
inline constexpr int kMostFactors = 14;  // Moller 1997 without division has 13

inline constexpr int kMostImages = 24;
// The most verdicts that one experiment asks for, including those of changed builds: 78 + 7 * (2 + kMostImages) = 260
// for at most 7 changes of numbers, 662 for orders of small integers and their images, 96 for other images, and fewer
// than 310 for scales.
inline constexpr int kMostAsked = 1330;

struct Experiment {
  Cause cause;
  bool settled;
  std::string evidence;   // "scaled by 2^10 it is right, by 2^9 wrong, …"
  std::string line = {};  // "mine.cpp:9", the line that decides; empty if it is not known
  bool slow = false;      // some pairs timed out, so the remaining ones were not tried
  int asked = 0;          // number of verdicts asked for
};

// Deterministic if the code is. Asks for at most kMostAsked verdicts. Each changed build takes about a second, but only
// once per process.
// Requires: a foreign lane whose verdict on the pair is not the truth; finite coordinates.
template <class Real>
Experiment experiment(const Lane& lane, Verdict verdict, const BasicPair<Real>& pair, Verdict truth);

// Like `experiment`, but remembers the results for lanes in the lane table. An experiment takes hundreds of verdicts,
// and a program may need a millisecond for each.   Thread-safe.
Experiment known_experiment(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth);

}  // namespace graze::analysis
