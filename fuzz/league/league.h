// SPDX-License-Identifier: Apache-2.0
// The league compares libraries and our algorithms on the same pairs. It counts errors within each lane's contract,
// pairs outside it, crashes, and verdicts that depend on the order. It also measures the time for a pair, and finds the
// smallest failure of each kind.
#pragma once

#include <array>
#include <compare>
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

// Groups of strata as in strata/groups.h, but near and exact contacts have a group of their own.
enum class LeagueGroup : std::uint8_t { general, near, coplanar, degenerate, extreme };
inline constexpr std::string_view kLeagueGroups[] = {"general", "near", "coplanar", "degenerate", "extreme"};
inline constexpr std::size_t kLeagueGroupCount = std::size(kLeagueGroups);
LeagueGroup league_group(std::string_view stratum);

// From margins of 2^kClearExponent ulps of the largest coordinate on, rounding an input to float32 excuses no wrong
// verdict.
inline constexpr int kClearExponent = 12;
inline constexpr std::string_view kClear = "clear";  // what such a failure has for its shape

// A lane's counts in a group of strata, on pairs within its contract. A verdict is wrong only if a fresh process
// repeats it.
struct LeagueCounts : Counts {
  std::uint64_t pairs = 0;    // within its contract
  std::uint64_t clear = 0;    // wrong ones with both triangles proper, not coplanar, |margin| >= 2^kClearExponent ulps
  std::uint64_t outside = 0;  // pairs that its convention leaves open
  std::uint64_t not_repeated = 0;  // not right at first, and right or otherwise in a fresh process

  LeagueCounts& operator+=(const LeagueCounts& other);
};

// A subject's smallest failure with this wrong verdict on pairs of this shape. The shape is kClear or that of
// shape_name.
struct LeagueFailure {
  const Lane* lane;  // the first of its subject that fails so
  std::string shape;
  Verdict verdict;  // in a fresh process; it is the way in which the lane is wrong
  AnyPair pair = Pair{};
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
  bool in_doubles = false;  // its pairs
  std::vector<std::string> strata;
  std::vector<LeagueRow> rows;
  std::vector<LeagueFailure> failures;      // of subjects in the rows' order
  std::uint64_t failures_not_repeated = 0;  // smallest failures that a fresh process did not show
};

// The lanes of the league: those of these patterns that are built as cpu, and their cpu-fma counterparts.
// Throws: as select_lanes.
SelectedLanes league_lanes(const std::vector<std::string>& globs);

// Limits of slow subjects, by name: such a subject gets at most this many pairs, the first ones of each stratum.
using MostPairs = std::map<std::string, std::uint64_t, std::less<>>;

// Runs the league on pairs of one type. The result does not depend on the number of threads. `stop` is called now and
// then with the number of pairs done; if it returns true, the result has only these pairs. Throws: OracleMismatch when
// two exact decisions differ.   Requires: lanes that decide this type.
League run_league(
    const SelectedLanes& under_test, std::vector<strata::PairSource> sources, std::uint64_t seed,
    const MostPairs& most = {},
    const std::function<bool(std::uint64_t done)>& stop = [](std::uint64_t) { return false; });

// Nanoseconds per pair of each row on the first pairs of `uniform`: the median of repetitions in which all rows take
// turns. For foreign code it is the time in its own process, without communication. Commands have no time.
inline constexpr std::size_t kLeagueTimedPairs = 1024, kLeagueRepetitions = 15;
std::vector<std::optional<double>> league_costs(const League& league);

}  // namespace graze::fuzz
