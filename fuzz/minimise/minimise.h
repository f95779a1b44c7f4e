// SPDX-License-Identifier: Apache-2.0
// The minimiser shrinks a pair while one algorithm's failure and its cause stay the same. It ends when no single move
// makes the pair simpler. The coordinate type stays too. simplicity.h defines which pair is simpler, and moves.h the
// single moves.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/explain.h"
#include "analysis/signature.h"
#include "core/simplify/simplicity.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {

// One algorithm's failure on a pair: the truth, which triangle lies in the other, and the verdict of each lane. Another
// pair fails alike if it has the same.
struct Failure {
  // By the exact decision of core/exact/exact.h; the oracle confirms the results (see confirm). Only the margin's sign
  // is part of it: keeping its size would force the coordinates to keep many digits.
  Relation truth;
  Nesting nesting;
  std::vector<const Lane*> lanes;    // of one algorithm, those among the lanes under test
  std::vector<DecideBlock> on_host;  // of each: the host lane or the twin
  std::vector<Verdict> verdicts;     // of each
  bool operator==(const Failure&) const = default;

  // Whether the pair has this truth and nesting.
  template <class Real>
  bool has_shape_of(const BasicPair<Real>& pair) const;

  // The first lane that is wrong on the pair, not counting lanes that differ only by their convention.   Requires: one
  // is.
  const Lane& first_wrong(const AnyPair& pair) const;
};

// The failures of a pair, one for each algorithm under test that is wrong on it. A pair with a coordinate that is not
// finite has none.   Throws: OracleMismatch; std::runtime_error where a lane's device and the twin differ.
std::vector<Failure> failures_of(const SelectedLanes& under_test, const AnyPair& pair);

bool fails_alike(const Failure& failure, const AnyPair& pair);

// The signature of a pair that fails alike, with the bucket of its own margin.
analysis::Signature signature_of(const Failure& failure, const AnyPair& pair);

// Why a failure happens. Its lanes may be wrong for different reasons; only that of the first wrong lane in table order
// counts. A pair fails for the same reason if the cause is the same. If no result of the lane's run was out of the
// exponents' range, none may become so, or a rounding error would shrink to numbers of 1e-30. On foreign code whose
// cause is a guess on the first pair (rounding or logic, not settled), a simpler pair may settle it, or show that not
// rounding but the order matters, settled or not; then that becomes the cause.
struct Reason {
  analysis::Cause cause;
  bool in_range;  // no result of the lane's source, run without contraction, leaves the exponents
  bool operator==(const Reason&) const = default;
};

// Requires: fails_alike(failure, pair).
Reason reason_of(const Failure& failure, const AnyPair& pair);
bool fails_for_reason(const Failure& failure, const Reason& reason, const AnyPair& pair);

// The limit of pairs that moves may make of a case; it then ends even if it is not minimal. Each pair takes at most one
// verdict of every lane and one exact decision. Finding the cause of a pair counts as kMovedPerCause pairs.
inline constexpr std::size_t kMostMoved = 1'500'000;
inline constexpr std::size_t kMovedPerCause = 500;
inline constexpr std::size_t kLeastMoved = 40 * kMovedPerCause;  // kept back to find the cause again, see minimise
// Each crash of foreign code costs a new process.
inline constexpr std::size_t kMostMovedCrashing = 100'000;

// Whether the failure can be shrunk. Timeouts are not, because each verdict takes the whole time limit, and neither are
// unstable verdicts.
bool can_shrink(const Failure& failure);

struct Minimised {
  AnyPair pair;                  // fails alike and for the same reason
  bool one_minimal = false;      // no single move makes it simpler and keeps that; otherwise the limit ended it
  std::size_t single_moves = 0;  // how many to a simpler pair were tried on it in vain, where it is minimal
  std::size_t moved = 0;         // pairs that moves made on the way, causes included
  Reason reason;                 // the pair's; the cause is that of the first pair
  AnyPair worst;                 // of all pairs on the way, the first one included, that of the largest margin in ulps
  double worst_ulps = 0;         // of either sign; the worst pair's cause may be another
};

// Repeats rounds over all kinds of moves until a round changes nothing. From each kind it takes the simplest pair that
// fails alike. A move that helped is repeated 2, 4, 8, … times as far while the pair gets simpler, and then bisected.
// The cause is expensive, so it is checked at the end. If it was lost, a bisection finds the step that lost it; from
// there on every pair's cause is checked. known: earlier results of this failure; if the search meets one, it returns
// that. most: replaces most_moved.
// Requires: fails_alike(failure, pair), most > kLeastMoved.   Throws: OracleMismatch.
std::size_t most_moved(const Failure& failure);  // kMostMoved, or kMostMovedCrashing
Minimised minimise(const Failure& failure, const AnyPair& pair, std::span<const Minimised> known = {},
                   std::optional<std::size_t> most = {});

// Confirms a result with the oracle and, for CUDA lanes, on the device if there is one. Throws: OracleMismatch if CGAL
// and GMP give another truth than the failure has; std::runtime_error if a lane gives another verdict.
void confirm(const SelectedLanes& under_test, const Failure& failure, const AnyPair& pair);

}  // namespace graze::fuzz
