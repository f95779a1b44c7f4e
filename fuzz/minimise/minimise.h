// SPDX-License-Identifier: Apache-2.0
// The minimiser: shrinks a pair while one algorithm's failure on it stays the same, and its cause, down to a pair that
// no single move makes simpler. simplicity.h states what is simpler, moves.h what a single move is.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/explain.h"
#include "analysis/signature.h"
#include "fuzz/minimise/simplicity.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {

// One algorithm's failure: the truth, and what each of its lanes says of it. A pair fails alike when all of it holds.
struct Failure {
  // By the exact decision of core/exact/exact.h; the oracle confirms the results (see confirm). It stays when the pair
  // shrinks. The margin's size need not: shrinking runs to the threshold, and would keep the coordinates long.
  Relation truth;
  std::vector<const Lane*> lanes;    // of one algorithm, those among the lanes under test
  std::vector<DecideBlock> on_host;  // of each: the host lane or the twin
  std::vector<Verdict> verdicts;     // of each
  bool operator==(const Failure&) const = default;

  // The first that is wrong on the pair, and does not only differ by its convention.   Requires: one is.
  const Lane& first_wrong(const Pair& pair) const;
};

// The failures of a pair, one for each algorithm among those under test that is wrong on it; none for coordinates that
// are not finite.   Throws: OracleMismatch; std::runtime_error where a lane's device and the twin differ.
std::vector<Failure> failures_of(const SelectedLanes& under_test, const Pair& pair);

bool fails_alike(const Failure& failure, const Pair& pair);

// The signature of a pair that fails alike, its own margin's bucket included.
analysis::Signature signature_of(const Failure& failure, const Pair& pair);

// Why a failure happens. Its lanes may be wrong for different reasons; the one that counts is that of the first wrong
// lane in the table's order. A pair fails for the same reason when the cause is the same and, where the lane's run left
// the scalar's exponents nowhere, it still does so nowhere: what rounding did must not end as numbers of 1e-30. Once
// nothing leaves the exponents on the way down, nothing does any more. Of foreign code, what is perhaps rounding may
// turn out to be the order on a simpler pair; then the cause is that of the simpler one.
struct Reason {
  analysis::Cause cause;
  bool in_range;  // no result of the lane's source, run without contraction, leaves the exponents
  bool operator==(const Reason&) const = default;
};

// Requires: fails_alike(failure, pair).
Reason reason_of(const Failure& failure, const Pair& pair);
bool fails_for_reason(const Failure& failure, const Reason& reason, const Pair& pair);

// A case ends after so many pairs that moves made of it, minimal or not. Each is asked for at most one verdict of every
// lane and one of the exact decision, so that eight lanes give at most nine times as many verdicts. Finding out the
// cause of a pair counts as kMovedPerCause.
inline constexpr std::size_t kMostMoved = 1'500'000;
inline constexpr std::size_t kMovedPerCause = 500;
inline constexpr std::size_t kLeastMoved = 40 * kMovedPerCause;  // kept back to find the cause again, see minimise
// Each crash of foreign code costs a new process.
inline constexpr std::size_t kMostMovedCrashing = 100'000;

// Whether the failure can be shrunk. Not where a lane takes all of its time for each verdict, and not where its
// verdicts change: such a pair stays as it is.
bool can_shrink(const Failure& failure);

struct Minimised {
  Pair pair;                     // fails alike and for the same reason
  bool one_minimal = false;      // no single move makes it simpler and keeps that; otherwise the limit ended it
  std::size_t single_moves = 0;  // how many to a simpler pair were tried on it in vain, where it is minimal
  std::size_t moved = 0;         // pairs that moves made on the way, causes included
  Reason reason;                 // the pair's; the cause is that of the first pair
  Pair worst;                    // of all pairs on the way, the first one included, that of the largest margin in ulps
  double worst_ulps = 0;         // of either sign; the worst pair's cause may be another
};

// Goes through the kinds of moves in their order, over and over, and takes of each the simplest pair that fails alike,
// until a whole round finds none. What a move did is done again 2, 4, 8, … times as far, while that makes the pair
// simpler still, and then bisected. The cause, which is dear, is asked for at the end. Where it was lost, a bisection
// of the way finds a pair that has it, followed by one that does not, and from there on every pair is asked.
// `known`: results of the same failure; one that is met is the result. `most`: in place of most_moved.
// Requires: fails_alike(failure, pair), most > kLeastMoved.   Throws: OracleMismatch.
std::size_t most_moved(const Failure& failure);  // kMostMoved, or kMostMovedCrashing
Minimised minimise(const Failure& failure, const Pair& pair, std::span<const Minimised> known = {},
                   std::optional<std::size_t> most = {});

// Throws: OracleMismatch unless CGAL and GMP say of the pair what the failure does; std::runtime_error unless all lanes
// under test do, on the device where it has one.
void confirm(const SelectedLanes& under_test, const Failure& failure, const Pair& pair);

}  // namespace graze::fuzz
