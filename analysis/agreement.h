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
  AgreementSweep rounded;          // the same lanes, but each operation rounds as written; null if they do so already
  std::vector<std::string> sites;  // sites at which the algorithm compares
  bool relative = true;            // whether both lanes run here under relative tolerances
  std::vector<strata::PairSource> sources;  // pairs used to choose
  std::vector<strata::PairSource> others;   // pairs to verify the choice on
  double max_rate = 1e-6;                   // the highest accepted rate of differing verdicts
};

struct Agreed {
  Agreement zero;  // without a tolerance, on the pairs used to choose
  std::vector<CurveOf<Agreement>> curves;
  std::vector<Agreement> picks;  // the best of each curve, on the other pairs
  // If only blunt tolerances make the lanes agree: the best of them, on the pairs used to choose.
  std::optional<Agreement> blunt;
  std::string chosen;  // policy; empty: compare with zero exactly
  TuneResult result = TuneResult::not_satisfiable;
  Agreement confirmed, zero_confirmed;  // on the other pairs
  double low = 0, high = 1;          // bounds of the rate of differing verdicts, one-sided, computed from `confirmed`
  std::optional<Agreement> rounded;  // of AgreeSpec::rounded, on the other pairs
};

// Whether the tolerance is blunt: it makes a lane wrong more often than no tolerance does, and at least as often as one
// fixed answer for all pairs would be.
bool is_blunt(const Agreement& under, const Agreement& zero);

// satisfied: the rate of differing verdicts is below max_rate, at 95 % confidence. not_confirmed, not_satisfiable: the
// rate is above max_rate, at 95 % confidence. too_few_pairs: there are too few pairs to show either.
TuneResult agreement_result(const Agreement& chosen_on, const Agreement& confirmed, double max_rate);

// Chooses a policy on some pairs and verifies it on other pairs. If the lanes agree without a policy, none is chosen.
// Otherwise the function finds the smallest tolerance of each curve under which the lanes agree. Among these tolerances
// it chooses the one with the fewest wrong verdicts of both lanes. It prefers tolerances under which no verdict
// differs, or whose upper bound is at most half of max_rate, because fresh pairs often do not confirm a rate near
// max_rate. If no tolerance makes the lanes agree, the choice is the policy with the fewest differing verdicts. Blunt
// tolerances are never chosen. Ties prefer no tolerance, then the order of the curves as in tune(), then the smallest
// tolerance. Requires: pairs in both lists.
Agreed agree(const AgreeSpec& spec);

}  // namespace graze::analysis
