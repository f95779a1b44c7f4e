// SPDX-License-Identifier: Apache-2.0
// The minimiser: shrinks a pair while one algorithm's failure on it stays the same, down to a pair that no single move
// makes simpler. simplicity.h states what is simpler, moves.h what a single move is.
#pragma once

#include <vector>

#include "analysis/signature.h"
#include "fuzz/lanes_under_test.h"
#include "fuzz/minimise/simplicity.h"

namespace graze::fuzz {

// What is true of a pair and must stay when it shrinks: all of its signature but the margin's size. Shrinking
// runs to the threshold, so a margin that had to keep its size would keep the coordinates long; its sign says whether
// the pair is apart, touches or overlaps.
struct Judged {
  Verdict verdict = Verdict::declined;
  Contact contact = Contact::unknown;
  oracle::Shape shape;
  int margin_sign = 0;
  bool operator==(const Judged&) const = default;
};

// By the exact decision of core/exact/exact.h; the oracle confirms the results (see confirm).
// Requires: finite coordinates.   Exact: always.
Judged judged(const Pair& pair);

// One algorithm's failure: the truth, and what each of its lanes says of it. A pair fails alike when all of it holds.
struct Failure {
  Judged truth;
  std::vector<const Lane*> lanes;    // of one algorithm, those of the under_test
  std::vector<DecideBlock> on_host;  // of each: the host lane or the twin
  std::vector<Verdict> verdicts;     // of each
  bool operator==(const Failure&) const = default;
};

// The failures of a pair, one for each algorithm of the under_test that is wrong on it; none for coordinates that are
// not finite.   Throws: OracleApart; std::runtime_error where the under_test's device and the twin differ.
std::vector<Failure> failures_of(const LanesUnderTest& under_test, const Pair& pair);

bool fails_alike(const Failure& failure, const Pair& pair);

// The signature of a pair that fails alike, its own margin's bucket included.
analysis::Signature signature_of(const Failure& failure, const Pair& pair);

struct Minimised {
  Pair pair;                     // not one of its single moves is simpler and fails alike
  std::size_t single_moves = 0;  // how many were tried on it
  Pair worst;                    // of all pairs on the way, the first one included, that of the largest margin in ulps
  double worst_ulps = 0;         // of either sign
};

// Goes through the kinds of moves in their order, over and over, and takes of each the simplest pair that fails alike,
// until a whole round finds none.
// Requires: fails_alike(failure, pair).   Throws: OracleApart.
Minimised minimise(const Failure& failure, const Pair& pair);

// What the moves of a kind make of the pair that is simpler than it, each pair once, the simplest first.
std::vector<Pair> simpler_moves(const Pair& pair, int kind);

// Throws: OracleApart unless CGAL and GMP say of the pair what the failure does; std::runtime_error unless all lanes of
// the under_test do, on the device where it has one.
void confirm(const LanesUnderTest& under_test, const Failure& failure, const Pair& pair);

}  // namespace graze::fuzz
