// SPDX-License-Identifier: Apache-2.0
// Checks whether an explanation names the real cause. The verdict must become right if only this cause is removed, and
// must stay wrong with this cause alone.
#pragma once

#include "analysis/explain.h"

namespace graze::analysis {

// The audit runs the lane twice: once without the cause, and once with nothing but the cause.
// cause         run without the cause                          run with the cause alone
// logic         none: logic cannot be removed                  exact arithmetic
// contraction   the named contractions are rounded, all        only the named contractions are fused; all
//               others stay fused; all are rounded if the      contractions if the explanation names none
//               explanation names none                         (then without exponent limits)
// fast math     the same source, rounded as written            none: what the lane computed is not known
// overflow,     without this exponent limit, and without       exact arithmetic with this limit alone
// underflow     both limits
// rounding      the wrong outcomes of the deciding             rounding to the scalar's mantissa, without
//               comparisons are corrected                      contraction and without exponent limits
// If the comparisons are known but no small set of them decides, the audit confirms only logic. The audit runs the
// lane's source in other arithmetic. A contracted lane uses the contraction rule that reproduces the lane's own run.
// Requires: an explanation's lane for this pair, and the pair's truth. The function does not read `lane.settled`.
Settled audit(const LaneExplanation& lane, const AnyPair& pair, Verdict truth);

}  // namespace graze::analysis
