// SPDX-License-Identifier: Apache-2.0
// Which epsilon: a lane's errors under many policies on the same pairs, the policy that serves best, and what is wrong
// with epsilons that no error count alone shows.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/lanes.h"
#include "strata/pair_source.h"

namespace graze::analysis {

// A pair of a source, by its place.
struct PairPlace {
  int source = -1;
  std::uint64_t index = 0;
  friend auto operator<=>(const PairPlace&, const PairPlace&) = default;
};

struct PolicyErrors {
  std::string policy;  // empty: zero
  std::uint64_t pairs = 0, misses = 0, false_hits = 0, declined = 0;
  std::uint64_t mended = 0, broken = 0;  // right, and the lane under no policy wrong; the other way round
  std::optional<PairPlace> first_mended, first_broken;

  std::uint64_t wrong() const { return misses + false_hits; }
  bool changes_nothing() const { return mended == 0 && broken == 0; }
  PolicyErrors& operator+=(const PolicyErrors& other);
};

// What decides under a policy; the empty one is zero.
using DecideUnder = std::function<DecideBlock(const std::string& policy)>;

// The number in the name of one tolerance, "rel:24" or "separation=abs:1e-6".
double tolerance_of(const std::string& policy);

// That of a published lane: on the host, or by its twin.   Throws: UsageError for a policy that it cannot have.
DecideUnder policies_of(const Lane& lane);

// The errors under each policy, on all pairs of the sources: drawn and judged once, then decided under each. The same
// whatever the threads (0: one on each core).
std::vector<PolicyErrors> sweep(const DecideUnder& decide, std::span<const std::string> policies,
                                std::span<const strata::PairSource> sources, int threads = 0);

// The pairs times 2^k; those for which that is not exact are left as they are.
std::vector<strata::PairSource> scaled(std::span<const strata::PairSource> sources, int k);

// Upper bound of the rate behind `count` of `of` cases: at it, so few come once in twenty times.
// Reference: Clopper and Pearson 1934, one-sided.
double upper_bound(std::uint64_t count, std::uint64_t of);

// What may not happen more often than a rate.
enum class Forbid { miss, false_hit, any };
std::uint64_t forbidden(const PolicyErrors& errors, Forbid forbid);

struct TuneSpec {
  DecideUnder decide;
  std::vector<std::string> sites;           // that the lane asks
  std::vector<strata::PairSource> sources;  // to choose on
  std::vector<strata::PairSource> others;   // to judge the choice on
  Forbid forbid = Forbid::any;
  double max_rate = 1e-6;
  int threads = 0;
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
  too_few_pairs,   // no error was seen, or few enough, but not on enough pairs to say so
  not_satisfiable  // no policy is good enough; the choice is the best there is
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

// Chooses on some pairs and judges on others. Of the policies whose rate of what is forbidden is low enough the one
// with the fewest other errors; of equals relative tolerances, then all sites, then the smallest tolerance.
// Requires: pairs in both lists.
Tuned tune(const TuneSpec& spec);

// The sites that the algorithm asks about, by name, on the first pairs of the sources.
std::vector<std::string> sites_asked(const Lane& lane, std::span<const strata::PairSource> sources);

}  // namespace graze::analysis
