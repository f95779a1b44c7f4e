// SPDX-License-Identifier: Apache-2.0
// The league: libraries' functions and our algorithms on the same pairs, counted side by side: what is wrong within
// each one's contract, what its convention leaves open, crashes, what depends on the order, what an answer costs; and
// the smallest failure of each kind.
#pragma once

#include <array>
#include <compare>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/counts.h"
#include "fuzz/selected_lanes.h"
#include "oracle/truth.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

// Strata that a reader of the league asks after together: as in strata/groups.h, but near and exact contacts apart.
enum class LeagueGroup : std::uint8_t { general, near, coplanar, degenerate, extreme };
inline constexpr std::string_view kLeagueGroups[] = {"general", "near", "coplanar", "degenerate", "extreme"};
inline constexpr std::size_t kLeagueGroupCount = std::size(kLeagueGroups);
LeagueGroup league_group(std::string_view stratum);

// From this many ulps of the largest coordinate on, no rounding of an input to float32 excuses a verdict.
inline constexpr int kClearExponent = 12;
inline constexpr std::string_view kClear = "clear";  // what such a failure has for its shape

// Of one row and group, for its pairs within the lane's contract. Wrong is what a fresh process said again.
struct LeagueCounts : Counts {
  std::uint64_t pairs = 0;    // within its contract
  std::uint64_t clear = 0;    // wrong ones with both triangles proper, not coplanar, |margin| >= 2^kClearExponent ulps
  std::uint64_t outside = 0;  // pairs that its convention leaves open
  std::uint64_t not_repeated = 0;  // not right at first, and right or otherwise in a fresh process

  LeagueCounts& operator+=(const LeagueCounts& other);
};

// The smallest failure of a subject's kind: on a shape (kClear, or what shape_name says) in a way.
struct LeagueFailure {
  const Lane* lane;  // the first of its subject that fails so
  std::string shape;
  Verdict verdict;  // in a fresh process; it is the way in which the lane is wrong
  Pair pair;
  oracle::Truth truth;  // by CGAL and GMP
  bool minimised;       // otherwise as it was met: a failure that would cost too much, or comes and goes
};

// One lane built as `cpu`.
struct LeagueRow {
  const Lane* lane;
  std::array<LeagueCounts, kLeagueGroupCount> groups;
  std::uint64_t order_dependent = 0, order_sample = 0;  // of pairs within its contract, asked in their 72 orders
  std::uint64_t breaks_invariant =
      0;  // of the same, asked as analysis::kInvariants says but for orders: mirrored, moved and so on
  std::optional<std::uint64_t> flips;  // of all pairs; nothing without a `cpu-fma` lane that runs here
};

struct League {
  std::uint64_t seed = 1, pairs = 0;
  std::vector<std::string> strata;
  std::vector<LeagueRow> rows;
  std::vector<LeagueFailure> failures;      // of subjects in the rows' order
  std::uint64_t failures_not_repeated = 0;  // smallest failures that a fresh process did not show
};

// The lanes of the league: those of these patterns that are built as cpu, and their cpu-fma counterparts.
// Throws: as select_lanes.
SelectedLanes league_lanes(const std::vector<std::string>& globs);

// A slow subject takes no more than so many pairs, the first of each stratum, by its name.
using MostPairs = std::map<std::string, std::uint64_t, std::less<>>;

// Runs it; deterministic, whatever the threads. `stop` is asked now and then with how many pairs are done, and ends it
// with what there is.   Throws: OracleMismatch when two exact decisions differ.
League run_league(
    const SelectedLanes& under_test, std::vector<strata::PairSource> sources, std::uint64_t seed,
    const MostPairs& most = {},
    const std::function<bool(std::uint64_t done)>& stop = [](std::uint64_t) { return false; });

// Nanoseconds a pair of each row on the first pairs of `uniform`: the median of repetitions in turn. Of foreign code
// what its own process took for it, without what the processes say to each other; nothing of a command.
inline constexpr std::size_t kLeagueTimedPairs = 1024, kLeagueRepetitions = 15;
std::vector<std::optional<double>> league_costs(const League& league);

}  // namespace graze::fuzz
