// SPDX-License-Identifier: Apache-2.0
// Which comparisons of a wrong lane decide: the smallest set whose correction makes the verdict right.
// To correct a comparison is to change its outcome alone, to the one that exact arithmetic gives at that point of the
// same path; no value changes. Where the outcome selects a value (the smaller end of a range, an absolute value), the
// lane goes on with the other value, as it computed it. All that follows is computed and compared as the lane does.
#pragma once

#include <functional>
#include <vector>

#include "analysis/lane_trace.h"
#include "oracle/precise.h"

namespace graze::analysis {

// A comparison whose outcome is wrong once those before it in the set are corrected.
struct Decider {
  std::size_t place;  // among what that run saw
  Seen<double> seen;
  oracle::ExactStep exact;
  Path path;      // all outcomes of that run
  Path before;    // those of the comparisons before it
  bool by_cause;  // see is_by_cause

  // Outcomes up to this one, corrected.
  Path corrected() const {
    Path outcomes = before;
    outcomes.push_back(exact.held);
    return outcomes;
  }
};

// No larger set is searched for.
inline constexpr int kMostDeciding = 4;

// What comparisons would say without the cause of the failure, along that path; one entry for each thing seen.
using WithoutCause = std::function<Trace<double>(const Path&)>;

// The smallest set; of equally small ones the first, their comparisons taken in order of execution. Empty where no set
// of up to kMostDeciding makes the verdict right.
// Requires: the lane's replay, with evidence; in exact arithmetic the algorithm says `truth`.
// without_cause: empty where exact arithmetic is what is without it.
std::vector<Decider> deciding_comparisons(const Lane& lane, const Pair& pair, Verdict truth, const Replay& replay,
                                          const WithoutCause& without_cause);

// Whether its outcome is right without the cause, or it compares what is not finite: that is the cause's doing,
// whatever rounding would say in its place.
bool is_by_cause(const Decider& decider, const WithoutCause& without_cause);

}  // namespace graze::analysis
