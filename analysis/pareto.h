// SPDX-License-Identifier: Apache-2.0
// Compares lanes' errors with their costs on the same pairs, and finds the Pareto front. Also measures how extreme
// pairs may be before a lane fails.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/extremes.h"
#include "analysis/tuning.h"
#include "cuda/lanes/device_costs.h"

namespace graze::analysis {

// Nanoseconds per pair on one core: the median of passes in which all lanes take turns, and the quartiles.
struct Cost {
  double low = 0, middle = 0, high = 0;
};

// How many pairs each call decides: all pairs, or a single pair as in most programs that use such a test.
enum class Calls { of_blocks, of_one };

// Nanoseconds per pair for one run of the lane over the pairs of the type that it takes.   Requires: pairs.
double nanoseconds_a_pair(const DecideBlock& lane, const strata::PairBlock& pairs, Calls calls = Calls::of_blocks);

// Requires: at least one.
Cost quartiles(std::vector<double> nanoseconds);

// Why timing the lane would not time its code, as for twins and for programs that answer line by line. Empty if the
// lane can be timed.
std::string why_not_timed(const Lane& lane);

// The costs of lanes. The time of a user's code is its own process's processor time, without communication. User code
// that takes no blocks decides one pair per call. A lane that is not timed, or failed on a pair, has no cost.
// Requires: pairs.
std::vector<std::optional<Cost>> costs_of(std::span<const Lane* const> lanes, const strata::PairBlock& pairs,
                                          int passes, Calls calls = Calls::of_blocks);

// The first `count` pairs, taken from the sources in turn. All are doubles if any source has doubles.
strata::PairBlock first_pairs(std::span<const strata::PairSource> sources, std::size_t count);

// A lane's errors and costs, to compare with other lanes.
struct Offer {
  std::string lane;
  PolicyErrors errors;
  std::optional<Cost> near = std::nullopt,
                      far = std::nullopt;  // near: pairs in a core's cache, or on the device. far: pairs in memory, or
                                           // copied to the device
  bool dominated = false;                  // by another lane, compared by `near`
  std::optional<cuda::KernelNeeds> needs = std::nullopt;  // on a device
  std::optional<AnyPair> failure = std::nullopt;          // a small pair on which the lane is wrong
  std::optional<Cost> alone = std::nullopt;               // on a core, if each call decides a single pair
  std::string why_not_timed = {};                         // the reason if there are no costs
};

// Whether another lane costs no more and errs no more, and either costs less or errs less. A declined pair has no
// verdict, so it counts as an error. Lanes without this cost are ignored.
bool is_dominated(const Offer& offer, const std::vector<Offer>& offers, std::optional<Cost> Offer::*by);
void mark_dominated(std::vector<Offer>& offers);

// Ways to make a source's pairs extreme. The truth is that of the changed pairs.
enum class Extreme {
  scale,     // times 2^k, exactly
  offset,    // 2^k times their size away from the origin, along (1, 1, 1)
  flatness,  // z times 2^-k: planes at angles of about 2^-k
  aspect     // x and y times 2^-k: needles
};
inline constexpr Extreme kExtremes[] = {Extreme::scale, Extreme::offset, Extreme::flatness, Extreme::aspect};
std::string_view name(Extreme extreme);

// The exponents at which an extreme is measured, from ordinary to most extreme in each direction.
std::vector<int> exponents(Extreme extreme);

std::vector<strata::PairSource> made_extreme(std::span<const strata::PairSource> sources, Extreme extreme,
                                             int exponent);

// A lane's errors at each exponent.
struct ExtremeCurve {
  std::string lane;
  Extreme extreme;
  std::vector<std::pair<int, PolicyErrors>> points;

  // Pairs without a right verdict at each exponent.
  std::vector<ErrorsAt> errors() const;
};

// The results of one machine; results of different machines are never mixed.
struct Pareto {
  std::string machine;
  bool on_device = false;
  int threads_at_once = 0;  // on a device's multiprocessor
  std::vector<Offer> offers;
  std::vector<ExtremeCurve> curves;
};

}  // namespace graze::analysis
