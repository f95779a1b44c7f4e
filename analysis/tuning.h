// SPDX-License-Identifier: Apache-2.0
// Which epsilon: a lane's errors under many policies on the same pairs, the policy that serves best, and what is wrong
// with epsilons that no error count alone shows.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/sweep.h"

namespace graze::analysis {

// The number in the name of one tolerance, "rel:24" or "separation=abs:1e-6".
double tolerance_of(const std::string& policy);

// The pairs times 2^k; those for which that is not exact are left as they are.
std::vector<strata::PairSource> scaled(Sources sources, int k);

// Upper bound of the rate behind `count` of `of` cases: at it, so few come once in twenty times.
// Reference: Clopper and Pearson 1934, one-sided.
double upper_bound(std::uint64_t count, std::uint64_t of);

// What may not happen more often than a rate.
enum class Forbid { false_negative, false_positive, any };
std::uint64_t forbidden(const PolicyErrors& errors, Forbid forbid);

// What a policy is judged by. Compares less for the better one: its rate of what is forbidden is low enough first, then
// by the other errors, then by those forbidden.
struct PolicyRank {
  bool too_many;
  std::uint64_t first, second;
  auto operator<=>(const PolicyRank&) const = default;
};
PolicyRank rank(const PolicyErrors& errors, Forbid forbid, double max_rate);

struct TuneSpec {
  Sweep sweep;
  std::vector<std::string> sites;           // that the lane asks
  std::vector<strata::PairSource> sources;  // to choose on
  std::vector<strata::PairSource> others;   // to judge the choice on
  Forbid forbid = Forbid::any;
  double max_rate = 1e-6;
};

// A tolerance swept over its range, at all sites or at one.
struct Curve {
  std::string site;  // empty: all
  bool relative = false;
  std::vector<PolicyErrors> points;  // by tolerance
};

// How far pairs may grow or shrink before the errors under a policy double; 0: not within kMostScale.
struct ScaleBreak {
  int up = 0, down = 0;  // exponents of two
  PolicyErrors at_up, at_down;
};
inline constexpr int kMostScale = 32;

// Errors of two sites, alone and together, by the chosen tolerance.
struct Interaction {
  std::string first, second;
  PolicyErrors of_first, of_second, together;
};

enum class TuneResult {
  satisfied,       // the rate's upper bound is below what is allowed
  too_few_pairs,   // few enough errors were seen, but not on enough pairs to say so
  not_confirmed,   // few enough on the pairs that it was chosen on, too many on the others
  not_satisfiable  // too many on the pairs of the choice under every policy; none has fewer there than the choice
};

struct Tuned {
  PolicyErrors zero;  // on the pairs to choose on
  std::vector<Curve> curves;
  std::string chosen;  // policy; empty: zero
  TuneResult result = TuneResult::not_satisfiable;
  PolicyErrors confirmed, zero_confirmed;  // on the others
  double bound = 1;                        // of the forbidden rate, by `confirmed`
  std::vector<std::string> dead;           // sites at which no tolerance changes any verdict
  ScaleBreak scale;
  std::vector<Interaction> interactions;
};

// What follows of the choice: its errors on the pairs that it was made on, those on the others, and their bound.
TuneResult result_of(const PolicyErrors& chosen_on, const PolicyErrors& confirmed, double bound, Forbid forbid,
                     double max_rate);

// Chooses on some pairs and judges on others. Of the policies whose rate of what is forbidden is low enough the one
// with the fewest other errors; of equals relative tolerances, then all sites, then the smallest tolerance.
// Requires: pairs in both lists.
Tuned tune(const TuneSpec& spec);

// The sites that the algorithm asks about, by name, on the first pairs of the sources.
std::vector<std::string> sites_asked(const Lane& lane, Sources sources);

}  // namespace graze::analysis
