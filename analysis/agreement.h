// SPDX-License-Identifier: Apache-2.0
// Finds the smallest tolerance under which two lanes give the same verdicts, and counts the wrong verdicts under it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/curves.h"
#include "analysis/tuning.h"

namespace graze::analysis {

struct AgreeSpec {
  AgreementSweep sweep;
  AgreementSweep rounded;          // the same lanes, rounding every operation as written; null if they already do
  std::vector<std::string> sites;  // sites at which the algorithm compares
  bool relative = true;            // whether both lanes run here under relative tolerances
  std::vector<strata::PairSource> sources;  // pairs on which the policy is chosen
  std::vector<strata::PairSource> others;   // other pairs, on which the choice is verified
  double max_rate = 1e-6;                   // the highest accepted rate of differing verdicts
};

struct Agreed {
  Agreement zero;  // without a tolerance, on AgreeSpec::sources
  std::vector<CurveOf<Agreement>> curves;
  std::vector<Agreement> picks;  // each curve's best point, on AgreeSpec::others
  // The best blunt tolerance, on AgreeSpec::sources; set if only blunt tolerances make the lanes agree.
  std::optional<Agreement> blunt;
  std::string chosen;  // policy; empty: compare with zero exactly
  TuneResult result = TuneResult::not_satisfiable;
  Agreement confirmed, zero_confirmed;  // on AgreeSpec::others
  double low = 0, high = 1;             // one-sided bounds on the rate of differing verdicts, from `confirmed`
  std::optional<Agreement> rounded;     // verdicts of AgreeSpec::rounded on AgreeSpec::others
};

// Whether the tolerance is blunt: a lane is wrong more often with it than without it, and at least as often as a
// constant answer would be.
bool is_blunt(const Agreement& under, const Agreement& zero);

// satisfied: at 95 % confidence, the rate of differing verdicts is below max_rate. not_confirmed, not_satisfiable: at
// 95 % confidence, it is above max_rate. too_few_pairs: too few pairs to show either.
TuneResult agreement_result(const Agreement& chosen_on, const Agreement& confirmed, double max_rate);

// Chooses a policy on some pairs and verifies it on other pairs. If the lanes agree without a policy, none is chosen.
// Otherwise the function finds the smallest tolerance of each curve under which the lanes agree. Among these tolerances
// it chooses the one with the fewest wrong verdicts of both lanes. It prefers tolerances under which no verdict
// differs, or under which the rate's upper bound is at most half of max_rate, because fresh pairs often do not confirm
// a rate near max_rate. If no tolerance makes the lanes agree, the choice is the policy with the fewest differing
// verdicts. Blunt tolerances are never chosen. Ties go to no tolerance, then to the earlier curve as in tune(), then to
// the smallest tolerance. Requires: pairs in both lists.
Agreed agree(const AgreeSpec& spec);

}  // namespace graze::analysis
