// SPDX-License-Identifier: Apache-2.0
// Finds the smallest tolerance under which two lanes give the same verdicts, and what it costs in wrong ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/curves.h"
#include "analysis/tuning.h"

namespace graze::analysis {

struct AgreeSpec {
  AgreementSweep sweep;
  AgreementSweep rounded;          // the same lanes, every operation rounded as written; null if they already are
  std::vector<std::string> sites;  // sites that the algorithm asks about
  bool relative = true;            // whether both lanes run here under relative tolerances
  std::vector<strata::PairSource> sources;  // pairs to choose on
  std::vector<strata::PairSource> others;   // pairs to verify the choice on
  double max_rate = 1e-6;                   // of differing verdicts
};

struct Agreed {
  Agreement zero;  // on the pairs of the choice
  std::vector<CurveOf<Agreement>> curves;
  std::vector<Agreement> picks;  // the best of each curve, on the other pairs
  // If only blunt tolerances make the lanes agree: the best of them, on the pairs used to choose.
  std::optional<Agreement> blunt;
  std::string chosen;  // policy; empty: compare with zero exactly
  TuneResult result = TuneResult::not_satisfiable;
  Agreement confirmed, zero_confirmed;  // on the other pairs
  double low = 0, high = 1;          // bounds of the rate of differing verdicts, one-sided, computed from `confirmed`
  std::optional<Agreement> rounded;  // of the lanes whose operations all round as written, on the other pairs
};

// Whether the tolerance is blunt: under it a lane has more wrong verdicts than without one, and at least as many as if
// it gave the same answer for all pairs.
bool is_blunt(const Agreement& under, const Agreement& zero);

// satisfied: differing verdicts are rarer than max_rate; not_confirmed or not_satisfiable: they are more frequent; each
// at 95 % confidence. too_few_pairs: the pairs show neither.
TuneResult agreement_result(const Agreement& chosen_on, const Agreement& confirmed, double max_rate);

// Chooses a policy on some pairs and verifies it on others. If the lanes agree without a policy, it chooses none.
// Otherwise it takes the smallest tolerance of each curve under which they agree, and among these the one with the
// fewest wrong verdicts of both lanes. It prefers tolerances under which no verdict differs, or whose upper bound is at
// most half of max_rate: fresh pairs often do not confirm a rate near max_rate. If no tolerance makes the lanes agree,
// it takes the policy with the fewest differing verdicts. Blunt tolerances are left out. Ties prefer no tolerance, then
// the order of the curves as in tune(), then the smallest tolerance. Requires: pairs in both lists.
Agreed agree(const AgreeSpec& spec);

}  // namespace graze::analysis
