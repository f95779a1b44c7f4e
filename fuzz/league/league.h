// SPDX-License-Identifier: Apache-2.0
// The league compares libraries and our algorithms on the same pairs. For each lane it counts errors on pairs within
// its contract, pairs outside its contract, crashes, and verdicts that depend on the vertex order. It also measures the
// time per pair and finds the smallest failure of each kind.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/any_pair.h"
#include "core/counts.h"
#include "fuzz/selected_lanes.h"
#include "oracle/truth.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

// The groups of strata/groups.h, except that near and exact contacts have their own group.
enum class LeagueGroup : std::uint8_t { general, near, coplanar, degenerate, extreme };
inline constexpr std::string_view kLeagueGroups[] = {"general", "near", "coplanar", "degenerate", "extreme"};
inline constexpr std::size_t kLeagueGroupCount = std::size(kLeagueGroups);
LeagueGroup league_group(std::string_view stratum);

// If the margin is at least 2^kClearExponent ulps of the largest coordinate, rounding the input to float32 cannot
// excuse a wrong verdict.
inline constexpr int kClearExponent = 12;
inline constexpr std::string_view kClear = "clear";  // the shape of such a failure

// A lane's counts in a group of strata, on pairs within its contract. A verdict counts as wrong only if a fresh process
// repeats it.
struct LeagueCounts : Counts {
  std::uint64_t pairs = 0;         // pairs within its contract
  std::uint64_t clear = 0;         // wrong on proper, not coplanar triangles; |margin| >= 2^kClearExponent ulps
  std::uint64_t outside = 0;       // pairs outside its contract
  std::uint64_t not_repeated = 0;  // verdicts that are not right, and differ in a fresh process

  LeagueCounts& operator+=(const LeagueCounts& other);
};

// A subject's smallest failure with this shape and wrong verdict. The shape is kClear, or a result of shape_name.
struct LeagueFailure {
  const Lane* lane;  // the subject's first lane that fails like this
  std::string shape;
  Verdict verdict;  // the wrong verdict, as given by a fresh process
  AnyPair pair = Pair{};
  oracle::Truth truth;  // from CGAL and GMP
  bool minimised;       // false: the original pair; minimising costs too much or the failure does not recur
};

// One row for each `cpu` lane.
struct LeagueRow {
  const Lane* lane;
  std::array<LeagueCounts, kLeagueGroupCount> groups;
  std::uint64_t order_dependent = 0, order_sample = 0;  // order_sample: pairs within its contract, in 72 orders
  std::uint64_t breaks_invariant =
      0;  // of the same pairs: those that break one of the other invariants in analysis::kInvariants
  std::optional<std::uint64_t> flips;  // verdicts that `cpu-fma` changes; nothing if no `cpu-fma` lane runs here
};

struct League {
  std::uint64_t seed = 1, pairs = 0;
  bool in_doubles = false;  // whether its pairs are doubles
  std::vector<std::string> strata;
  std::vector<LeagueRow> rows;
  std::vector<LeagueFailure> failures;      // in the rows' order of subjects
  std::uint64_t failures_not_repeated = 0;  // smallest failures that a fresh process did not repeat
};

// The league's lanes: the `cpu` lanes that match the patterns, and their `cpu-fma` counterparts.
// Throws: the errors of select_lanes.
SelectedLanes league_lanes(const std::vector<std::string>& globs);

// Limits for slow subjects, by name: the subject gets only this many pairs, the first ones of each stratum.
using MostPairs = std::map<std::string, std::uint64_t, std::less<>>;

// Runs the league on pairs of one coordinate type. The result does not depend on the number of threads. `stop` is
// called from time to time with the number of pairs done; if it returns true, the result covers only these pairs.
// Requires: lanes that decide this type.   Throws: OracleMismatch if two exact decisions differ.
League run_league(
    const SelectedLanes& under_test, std::vector<strata::PairSource> sources, std::uint64_t seed,
    const MostPairs& most = {},
    const std::function<bool(std::uint64_t done)>& stop = [](std::uint64_t) { return false; });

// Each row's nanoseconds per pair on the first pairs of `uniform`: the median over repetitions, in which the rows run
// in turn. For foreign code: the time in the code's process, without communication. Command subjects have no time.
inline constexpr std::size_t kLeagueTimedPairs = 1024;
inline constexpr int kLeagueRepetitions = 15;
std::vector<std::optional<double>> league_costs(const League& league);

}  // namespace graze::fuzz
