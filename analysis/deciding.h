// SPDX-License-Identifier: Apache-2.0
// Which comparison of a wrong lane decides: the first one that, its two sides alone replaced by their exact values and
// all that follows computed from them as the lane does, makes the verdict right.
#pragma once

#include <functional>
#include <vector>

#include "analysis/lane_trace.h"
#include "oracle/precise.h"

namespace graze::analysis {

// A comparison that goes wrong.
struct Decider {
  std::size_t place;  // in the run's `seen`; of a later one in a set, in the run with those before it corrected
  Seen<double> seen;
  oracle::ExactStep exact;
  Path before;                  // outcomes of the comparisons before it
  Correction<double> to_exact;  // gives the lane the exact values, rounded to its scalar, and the exact outcome
  Correction<double> to_lane;   // gives exact arithmetic the lane's values and outcome
};

struct Deciding {
  std::vector<Decider> comparisons;  // one; or, where no single one does, a set that does together, in order
  bool smallest = true;              // no smaller set of comparisons that go wrong does
  bool by_cause = true;              // each of them goes right without the cause
};

// What comparisons would say without the cause of the failure, along that path; one entry for each of the run's `seen`.
using WithoutCause = std::function<Trace<double>(const Path&)>;

// Rather comparisons that go wrong in the lane and right without the cause, or of what is not finite any more (where it
// is empty: all that go wrong); where these do not suffice, any. Sets of up to three are searched for the smallest.
// Requires: the lane's replay, with evidence, and its exact steps; in exact arithmetic the algorithm says `truth`,
// found with so many bits.
Deciding deciding_comparisons(const Lane& lane, const Pair& pair, Verdict truth, const Replay& replay,
                              const std::vector<oracle::ExactStep>& exact, int bits, const WithoutCause& without_cause);

}  // namespace graze::analysis
