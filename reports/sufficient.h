// SPDX-License-Identifier: Apache-2.0
// Finds the cheapest published lane, with its tolerance, that is right often enough in a scene.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/pareto.h"
#include "analysis/tuning.h"
#include "core/lanes/lanes.h"

namespace graze::reports {

// A lane with the tolerance that was chosen for the rate, and its cost with that tolerance.
struct Candidate {
  std::string lane;  // with its tolerance
  Scalar scalar;
  analysis::TuneResult result;
  analysis::PolicyErrors errors;  // on pairs that were not used to choose the tolerance
  double bound;                   // upper bound of the rate of wrong verdicts, at 95 % confidence
  analysis::Cost cost;
};

// The cheapest candidate whose rate is low enough; null if there is none.
// scalar: if given, only candidates of this scalar count.
const Candidate* cheapest_sufficient(std::span<const Candidate> candidates,
                                     std::optional<Scalar> scalar = std::nullopt);

// Describes which lane to use at this rate of wrong verdicts, what the other precision would change, and what `exact`
// costs. A lane is not called cheaper if the spreads of the costs overlap.   Requires: at least one candidate.
std::vector<std::string> sufficient_sentences(double rate, std::span<const Candidate> candidates,
                                              const std::string& exact, const analysis::Cost& exact_cost);

}  // namespace graze::reports
