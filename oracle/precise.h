// SPDX-License-Identifier: Apache-2.0
// Runs the algorithms in other arithmetic than a lane's, with MPFR: with more bits, without limits of the exponent, or
// exactly. An algorithm is given by its index in Algorithms (core/algorithms/algorithms.h). A pair of float32 is
// passed as the same numbers in double.
#pragma once

#include <string>
#include <vector>

#include "core/algorithms/traced.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze::oracle {

// Which exponent limits of a scalar to apply. Beyond the upper limit numbers become infinite; below the lower limit
// they become subnormal, then zero.
struct Limits {
  bool upper = false;
  bool lower = false;
};

enum class RangeEvent { none, overflow, underflow };
struct Limited {
  Verdict verdict;
  RangeEvent first;  // the first result that the exponent limits changed
};

// Runs the algorithm with the scalar's mantissa, round to nearest even. With both limits it equals the cpu lane.
// Requires: the scalar holds the coordinates.
Limited decide_limited(int algorithm, Scalar scalar, const DoublePair& pair, Limits limits);

// Like decide_limited, but traced, contracted by the rule, and led along the given path. A value beyond the
// range of double becomes infinite, and one below it zero or subnormal.
Trace<double> run_limited(int algorithm, Scalar scalar, const DoublePair& pair, Limits limits, Contraction rule,
                          const Path& lead = {});

// Runs the algorithm with a mantissa of `bits` bits and no exponent limits.
Verdict decide_with_bits(int algorithm, const DoublePair& pair, int bits);

// The least number of bits, not below `least`, such that it and every greater number up to kMostBits give this verdict.
// 0 if kMostBits bits do not give it.
inline constexpr int kMostBits = 512;
int bits_needed(int algorithm, const DoublePair& pair, Verdict verdict, int least);

// The algorithm in exact arithmetic, with error bounds: two numbers count as equal if their bounds cannot tell them
// apart.
struct Exactly {
  Verdict verdict;
  int bits;      // bits of the mantissas
  bool certain;  // the bounds decided every comparison
  bool settled;  // certain, or a run with a quarter of the bits left as many comparisons open, with the same outcomes
};
Exactly decide_exactly(int algorithm, const DoublePair& pair);

// Runs the algorithm in exact arithmetic, but with these exponent limits of the scalar.
// Requires: bits as found by decide_exactly.
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

// The exact values of a lane's run, step by step, along the path that the lane took. Uses as many bits as that path
// needs.
// Requires: `run` is a run of that algorithm in that scalar.
std::vector<ExactStep> exact_steps(int algorithm, Scalar scalar, const DoublePair& pair, const Trace<double>& run);

// Like exact_steps, but returns only the outcomes of the comparisons on the path.
Path exact_outcomes(int algorithm, const DoublePair& pair, const Path& path);

}  // namespace graze::oracle
