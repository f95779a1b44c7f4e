// SPDX-License-Identifier: Apache-2.0
// The minimiser shrinks a pair while one algorithm's failure and its cause stay the same. The search ends when no
// single move makes the pair simpler. The coordinate type does not change. simplicity.h defines which pair is simpler,
// and moves.h defines the single moves.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/explain.h"
#include "analysis/signature.h"
#include "core/simplify/simplicity.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {

// One algorithm's failure on a pair: the truth, the nesting, and the verdict of each lane. Another pair fails alike if
// its truth, nesting and verdicts are the same.
struct Failure {
  // Computed by the exact decision in core/exact/exact.h; the oracle confirms the results (see confirm). Has only the
  // margin's sign, because a fixed size of the margin would force the coordinates to keep many digits.
  Relation truth;
  Nesting nesting;
  std::vector<const Lane*> lanes;    // the algorithm's lanes among the lanes under test
  std::vector<DecideBlock> on_host;  // for each lane: the host lane or the twin
  std::vector<Verdict> verdicts;     // of each lane
  bool operator==(const Failure&) const = default;

  // Whether the pair has this truth and nesting.
  template <class Real>
  bool has_shape_of(const BasicPair<Real>& pair) const;

  // The first lane that is wrong on the pair, ignoring lanes excused by their convention.   Requires: a lane is wrong.
  const Lane& first_wrong(const AnyPair& pair) const;
};

// The failures of a pair, one for each algorithm under test that is wrong on it. A pair with a coordinate that is not
// finite has no failures.   Throws: OracleMismatch; std::runtime_error if a lane's device and twin differ.
std::vector<Failure> failures_of(const SelectedLanes& under_test, const AnyPair& pair);

bool fails_alike(const Failure& failure, const AnyPair& pair);

// The signature of a pair that fails alike, with the bucket of that pair's own margin.
analysis::Signature signature_of(const Failure& failure, const AnyPair& pair);

// Why a failure happens. A failure's lanes may be wrong for different reasons; only the reason of the first wrong lane
// in table order counts. A pair fails for the same reason if the cause is the same. If no value in the lane's run
// overflows or underflows on the first pair, none may do so on the minimised pair; otherwise the pair would shrink to
// coordinates around 1e-30. For foreign code, the first pair's cause may be a guess (rounding or logic, not settled). A
// simpler pair's cause replaces a guess if this cause is settled, or if it is the vertex order and the guess was
// rounding.
struct Reason {
  analysis::Cause cause;
  bool in_range;  // no result of the lane's source, run without contraction, leaves the exponents' range
  bool operator==(const Reason&) const = default;
};

// Requires: fails_alike(failure, pair).
Reason reason_of(const Failure& failure, const AnyPair& pair);
bool fails_for_reason(const Failure& failure, const Reason& reason, const AnyPair& pair);

// The number of pairs that moves may try for a case. At this limit the search ends even if the pair is not minimal.
// Each pair costs at most one verdict per lane and one exact decision. Finding a cause counts as kMovedPerCause pairs.
inline constexpr std::size_t kMostMoved = 1'500'000;
inline constexpr std::size_t kMovedPerCause = 500;
inline constexpr std::size_t kLeastMoved = 40 * kMovedPerCause;  // reserved for finding the cause again, see minimise
// Each crash of foreign code costs a new process.
inline constexpr std::size_t kMostMovedCrashing = 100'000;

// Whether the failure can be shrunk. A timeout cannot be shrunk, because each verdict takes the whole time limit. An
// unstable verdict cannot be shrunk either.
bool can_shrink(const Failure& failure);

struct Minimised {
  AnyPair pair;                  // fails alike, for the same reason
  bool one_minimal = false;      // no single move makes it simpler and keeps failure and reason; false: not proven
  std::size_t single_moves = 0;  // if one_minimal: how many moves from the pair were tried and failed
  std::size_t moved = 0;         // pairs that moves tried; each search for a cause adds kMovedPerCause
  analysis::Cause first_cause;   // the first pair's cause
  Reason reason;                 // the pair's own; the cause differs from first_cause only if that was a guess
  AnyPair worst;                 // the pair with the largest margin in ulps, of the first pair and all visited ones
  double worst_ulps = 0;         // that margin, of either sign; the worst pair may have another cause
};

// Repeats rounds over all kinds of moves until a round changes nothing. From each kind of move it takes the simplest
// pair that fails alike. A move that helped is repeated 2, 4, 8, … times at once while the pair gets simpler, and then
// bisected. Finding a cause is expensive, so the cause is checked only at the end. If the cause was lost, a bisection
// finds the step that lost it, and every later pair's cause is checked.
// known: earlier results for this failure; if the search reaches one of them, it returns that result.
// most: the limit, instead of most_moved.
// Requires: fails_alike(failure, pair), most > kLeastMoved.   Throws: OracleMismatch.
std::size_t most_moved(const Failure& failure);  // returns kMostMoved or kMostMovedCrashing
Minimised minimise(const Failure& failure, const AnyPair& pair, std::span<const Minimised> known = {},
                   std::optional<std::size_t> most = {});

// Confirms a result with the oracle and, for CUDA lanes, on the device if there is one. Throws: OracleMismatch if the
// oracle's truth differs from the failure's; std::runtime_error if a lane gives a different verdict.
void confirm(const SelectedLanes& under_test, const Failure& failure, const AnyPair& pair);

}  // namespace graze::fuzz
