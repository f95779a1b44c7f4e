// SPDX-License-Identifier: Apache-2.0
// Chooses an epsilon: compares a lane's errors under many policies on the same pairs and finds the best policy. Also
// reports problems with epsilons that error counts alone do not show.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/curves.h"
#include "analysis/sweep.h"
#include "core/wilson.h"

namespace graze::analysis {

// The pairs times 2^k; pairs that cannot be scaled exactly do not change.
std::vector<strata::PairSource> scaled(Sources sources, int k);

// Upper 95 % confidence bound on the rate if `count` of `of` cases are seen: at this rate, the probability of so low a
// count is 5 %. Rounded outward.   Reference: Clopper and Pearson 1934, one-sided.
double upper_bound(std::uint64_t count, std::uint64_t of);

// Lower bound: at this rate, the probability of so high a count is 5 %. Rounded outward.
double lower_bound(std::uint64_t count, std::uint64_t of);

// The kind of error whose rate is limited.
enum class Forbid { false_negative, false_positive, any };
std::uint64_t forbidden(const PolicyErrors& errors, Forbid forbid);

// A policy's rank; better policies have smaller ranks. A low enough rate of forbidden errors comes first, then the
// number of other errors, then the number of forbidden ones. If the rate is too high, forbidden errors are compared
// before others.
struct PolicyRank {
  bool too_many;
  std::uint64_t first, second;
  auto operator<=>(const PolicyRank&) const = default;
};
PolicyRank rank(const PolicyErrors& errors, Forbid forbid, double max_rate);

struct TuneSpec {
  Sweep sweep;
  bool by_value = false;                    // the tolerance is the value of an epsilon in a user's source
  std::vector<std::string> sites;           // sites at which the lane compares; none if by_value
  std::vector<strata::PairSource> sources;  // pairs on which the policy is chosen
  std::vector<strata::PairSource> others;   // other pairs, on which the choice is verified
  Forbid forbid = Forbid::any;
  double max_rate = 1e-6, max_other = 0.1;  // limits on the rates of forbidden errors and of other errors
};

using Curve = CurveOf<PolicyErrors>;

// How far pairs may grow or shrink before a policy's errors, or only its forbidden errors, double. `up` or `down` is 0
// if the errors do not double up to kMostScale. Measured on pairs that were not used to choose the policy.
struct ScaleBreak {
  int up = 0, down = 0;  // exponents of two
  PolicyErrors here, at_up, at_down;
};
// Whether bounds on both rates, at 95 % confidence, prove that the rate of errors more than doubled.
inline bool doubles(std::uint64_t before, std::uint64_t after, std::uint64_t pairs) {
  return share_of(after, pairs).low > 2 * share_of(before, pairs).high;
}
inline constexpr int kMostScale = 32;

// Errors with the chosen tolerance at each of two sites separately, and at both together.
struct Interaction {
  std::string first, second;
  PolicyErrors of_first, of_second, together;
};

enum class TuneResult {
  satisfied,        // the upper bounds of both rates are at most max_rate and max_other
  too_few_pairs,    // few enough errors, but on too few pairs to prove it
  not_confirmed,    // few enough forbidden errors on TuneSpec::sources, but too many on TuneSpec::others
  not_satisfiable,  // every policy has too many forbidden errors on TuneSpec::sources; the chosen one has the fewest
  not_useful        // few enough forbidden errors, but a higher rate of other errors than max_other
};

struct Tuned {
  PolicyErrors zero;  // on TuneSpec::sources
  std::vector<Curve> curves;
  std::string chosen;  // policy; empty: compare with zero exactly
  TuneResult result = TuneResult::not_satisfiable;
  PolicyErrors confirmed, zero_confirmed;  // on TuneSpec::others
  double bound = 1, other_bound = 1;       // upper bounds of both rates, computed from `confirmed`
  std::vector<std::string> dead;           // sites at which no tolerance changes any verdict
  ScaleBreak scale;
  std::vector<Interaction> interactions;
};

// The upper bound on the rate of errors that are not forbidden; 0 if all errors are forbidden.
double other_bound(const PolicyErrors& errors, Forbid forbid);

// Judges the choice by its errors on TuneSpec::sources and on TuneSpec::others.
TuneResult result_of(const PolicyErrors& chosen_on, const PolicyErrors& confirmed, Forbid forbid, double max_rate,
                     double max_other);

// The best policy of each curve.   Requires: points on each.
std::vector<const PolicyErrors*> best_of_curves(const std::vector<Curve>& curves, Forbid forbid, double max_rate);

// Chooses a policy on some pairs and verifies it on others. Among the policies whose forbidden rate is low enough, it
// takes the one with the fewest other errors. Ties go to no tolerance, then to relative tolerances at all sites,
// absolute ones at all sites, single sites, and finally the smallest tolerance.
// Requires: pairs in both lists.
Tuned tune(const TuneSpec& spec);

// The names of the sites at which the algorithm compares on the first 500 pairs of each source.
std::vector<std::string> sites_asked(const Lane& lane, Sources sources);

}  // namespace graze::analysis
