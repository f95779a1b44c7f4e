// SPDX-License-Identifier: Apache-2.0
// Finds the comparisons that decide a wrong lane's verdict: the smallest set whose correction makes the verdict right.
// A corrected comparison takes the outcome that exact arithmetic gives at that point of the same path. No value
// changes. If the outcome selects a value (the smaller end of a range, an absolute value), the lane continues with the
// other value as it computed it. All later steps run as in the lane.
#pragma once

#include <functional>
#include <vector>

#include "analysis/lane_trace.h"
#include "oracle/precise.h"

namespace graze::analysis {

// A deciding comparison. Its outcome is wrong in the run in which the earlier comparisons of its set are corrected.
struct Decider {
  std::size_t place;  // index in that run's trace
  Seen<double> seen;
  oracle::ExactStep exact;
  Path path;      // all outcomes of that run
  Path before;    // the outcomes of the comparisons before it
  bool by_cause;  // see is_by_cause

  // The outcomes up to and including this comparison, with this one corrected.
  Path corrected() const {
    Path outcomes = before;
    outcomes.push_back(exact.held);
    return outcomes;
  }
};

// The size of the largest sets that the search tries.
inline constexpr int kMostDeciding = 4;

// Returns the trace of a run along this path without the cause, with one entry for each value or comparison.
using WithoutCause = std::function<Trace<double>(const Path&)>;

// Returns the smallest set; among equally small sets, the first in order of execution. Empty if no set of up to
// kMostDeciding comparisons makes the verdict right.
// Requires: a replay of the lane that has evidence; the algorithm in exact arithmetic returns `truth`.
// without_cause: empty if the run without the cause is the run in exact arithmetic.
std::vector<Decider> deciding_comparisons(const Lane& lane, const AnyPair& pair, Verdict truth, const Replay& replay,
                                          const WithoutCause& without_cause);

// Whether the comparison's outcome is right without the cause, or an operand is not finite. A non-finite operand counts
// as an effect of the cause, even if rounding alone would make the outcome wrong too.
bool is_by_cause(const Decider& decider, const WithoutCause& without_cause);

}  // namespace graze::analysis
