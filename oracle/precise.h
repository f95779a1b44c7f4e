// SPDX-License-Identifier: Apache-2.0
// Runs the algorithms with MPFR in arithmetic that no lane has: with more bits, without exponent limits, or exactly. An
// algorithm is given by its index in Algorithms (core/algorithms/algorithms.h). A float32 pair is passed as the same
// numbers in double.
#pragma once

#include <string>
#include <vector>

#include "core/algorithms/traced.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze::oracle {

// Which exponent limits of a scalar to apply. Numbers above the upper limit become infinite; numbers below the lower
// limit become subnormal or zero.
struct Limits {
  bool upper = false;
  bool lower = false;
};

enum class RangeEvent { none, overflow, underflow };
struct Limited {
  Verdict verdict;
  RangeEvent first;  // the first result that the exponent limits changed
};

// Runs the algorithm with the scalar's mantissa, round to nearest even. With both limits it is the cpu lane's run.
// Requires: the scalar holds the coordinates.
Limited decide_limited(int algorithm, Scalar scalar, const DoublePair& pair, Limits limits);

// Like decide_limited, but records a trace, contracts by the rule, and follows the path `lead`. In the trace, a value
// too large for a double becomes infinite, and one too small becomes subnormal or zero.
Trace<double> run_limited(int algorithm, Scalar scalar, const DoublePair& pair, Limits limits, Contraction rule,
                          const Path& lead = {});

// Runs the algorithm with a mantissa of `bits` bits, without exponent limits or with those of a scalar.
// Requires: the scalar's mantissa has at most `bits` bits.
Verdict decide_with_bits(int algorithm, const DoublePair& pair, int bits);
Verdict decide_with_bits(int algorithm, const DoublePair& pair, int bits, Scalar exponents);

// The least number n of bits, n >= `least`, such that n to kMostBits bits without exponent limits all give this
// verdict; 0 if kMostBits bits give another verdict.
inline constexpr int kMostBits = 512;
int bits_needed(int algorithm, const DoublePair& pair, Verdict verdict, int least);

// The algorithm's result in exact arithmetic, computed with error bounds. Two numbers count as equal if their bounds
// cannot distinguish them.
struct Exactly {
  Verdict verdict;
  int bits;      // bits of the mantissas
  bool certain;  // the bounds decided every comparison
  bool settled;  // certain, or open with so many bits that only equal polynomials stay open, and a quarter of the bits
                 // left the same number of comparisons open, with the same outcomes
};
Exactly decide_exactly(int algorithm, const DoublePair& pair);

// Runs the algorithm in exact arithmetic, but with the scalar's exponent limits that `limits` selects.
// Requires: `bits` is the number that decide_exactly returned.
Verdict decide_exactly_but(int algorithm, Scalar scalar, const DoublePair& pair, int bits, Limits limits);

// A lane's number and its exact value.
struct Beside {
  double lane;
  double exact;         // rounded; may be 0 or infinite even if `decimal` is neither
  std::string decimal;  // 6 digits; "0" only if it cannot be distinguished from zero
  double ulps;          // the lane's error, in ulps of the exact number, ignoring exponent limits
};

struct ExactStep {
  Beside left, right;
  Beside difference;  // left minus right
  bool held;          // the outcome with the exact numbers
};

// The exact values for a lane's run, step by step, along the lane's path, with as many bits as this path needs.
// Requires: `run` is a run of this algorithm in this scalar.
std::vector<ExactStep> exact_steps(int algorithm, Scalar scalar, const DoublePair& pair, const Trace<double>& run);

// Like exact_steps, but returns only the outcomes of the comparisons on the path.
Path exact_outcomes(int algorithm, const DoublePair& pair, const Path& path);

}  // namespace graze::oracle
