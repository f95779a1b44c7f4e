// SPDX-License-Identifier: Apache-2.0
// The algorithms in other arithmetic than a lane's, by MPFR: with more bits, without limits of the exponent, exactly.
// Algorithms are named by their place in Algorithms (core/algorithms/algorithms.h).
#pragma once

#include <string>
#include <vector>

#include "core/algorithms/traced.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze::oracle {

// Which ends of a scalar's exponents an arithmetic has: beyond them numbers become infinite, or subnormal and zero.
struct Limits {
  bool upper = false;
  bool lower = false;
};

enum class RangeEvent { none, overflow, underflow };
struct Limited {
  Verdict verdict;
  RangeEvent first;  // result that left the exponents and was changed by it
};

// The algorithm with the scalar's mantissa, round to nearest even. With both limits it is the scalar's cpu lane.
Limited decide_limited(int algorithm, Scalar scalar, const Pair& pair, Limits limits);

// The same, written down: contracted by that rule, and led down the path. Values beyond the doubles are rounded to
// them.
Trace<double> run_limited(int algorithm, Scalar scalar, const Pair& pair, Limits limits, Contraction rule,
                          const Path& lead = {});

// The algorithm with a mantissa of that many bits, and exponents without limits.
Verdict decide_with_bits(int algorithm, const Pair& pair, int bits);

// Least number of bits, from `least` on, such that the algorithm gives this verdict with it and with any more of up to
// kMostBits; 0 when it does not give it with kMostBits.
inline constexpr int kMostBits = 512;
int bits_needed(int algorithm, const Pair& pair, Verdict verdict, int least);

// The algorithm in exact arithmetic, by error bounds: two numbers count as equal when their bounds leave that open.
struct Exactly {
  Verdict verdict;
  int bits;      // that its mantissas were given
  bool certain;  // no comparison was left open. Otherwise four times the bits less left the same ones open
  bool settled;  // certain, or as said
};
Exactly decide_exactly(int algorithm, const Pair& pair);

// The algorithm in exact arithmetic, but for one end of the scalar's exponents.
// Requires: bits as decide_exactly found them.
Verdict decide_exactly_but(int algorithm, Scalar scalar, const Pair& pair, int bits, Limits limits);

// A number of a lane beside what it should be.
struct Beside {
  double lane;
  double exact;         // rounded; may be 0 or infinite where `decimal` is neither
  std::string decimal;  // to 6 digits; "0" only for what cannot be told from zero
  double ulps;          // the lane's error, in ulps of the exact number without limits of the exponent
};

struct ExactStep {
  Beside left, right;
  Beside difference;  // left less right
  bool held;          // by the exact numbers
};

// The exact values of a lane's run, step by step, along the path that the lane took.
// With as many bits as that path needs.
// Requires: run is of that algorithm in that scalar.
std::vector<ExactStep> exact_steps(int algorithm, Scalar scalar, const Pair& pair, const Trace<double>& run);

// The outcomes alone, of each comparison on the path.
Path exact_outcomes(int algorithm, const Pair& pair, const Path& path);

}  // namespace graze::oracle
