// SPDX-License-Identifier: Apache-2.0
// Whether the cause that an explanation names is the cause: the verdict becomes right when it alone is taken away, and
// stays wrong when all else is.
#pragma once

#include "analysis/explain.h"

namespace graze::analysis {

// What is taken away, and what is left when all else is:
//   logic        nothing can be; exact arithmetic
//   contraction  the contractions named, all others staying; only these. Where they are not known: all; all without
//                limits of the exponent
//   fast math    the compiler's freedom; what is left cannot be run, for what was computed is not known
//   overflow, underflow   that limit of the exponent, and both; exact arithmetic with that limit alone
//   rounding     the wrong outcomes of the deciding comparisons; rounding to the scalar's mantissa, without contraction
//                and limits of the exponent
// Where comparisons are known but no few of them decide, no cause but logic and fast math stands up to it.
// The lane's source is run in other arithmetic for it, a contracted one by the rule that gives the lane's own run.
// Requires: an explanation's lane for this pair, whose truth this is; its `settled` is not read.
Settled audit(const LaneExplanation& lane, const Pair& pair, Verdict truth);

}  // namespace graze::analysis
