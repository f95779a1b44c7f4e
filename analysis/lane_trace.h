// SPDX-License-Identifier: Apache-2.0
// A lane's run, written down: each comparison, and each value that it asks its policy about, in its own arithmetic.
#pragma once

#include "core/algorithms/traced.h"
#include "core/lanes/lanes.h"

namespace graze::analysis {

// source: the lane is the algorithm's source without contraction, and so is the replay. hash: contracted by a rule, and
// all values asked of the policy have the hash that the lane's twin gives them. verdict: contracted by a rule, and the
// verdict is the lane's; the values may not be. none: no rule gave even that.
enum class Evidence { source, hash, verdict, none };
std::string_view name(Evidence evidence);
std::string_view name(Contraction rule);

struct Replay {
  Contraction rule = Contraction::none;
  Evidence evidence = Evidence::none;
  Trace<double> run;
};

// The lane's run on the pair; without evidence for a lane whose operations the compiler rewrites.
Replay replay(const Lane& lane, const Pair& pair);

// The same in other circumstances: the algorithm in the lane's scalar and by that rule, led down the path.
Trace<double> run_led(const Lane& lane, const Pair& pair, Contraction rule, const Path& lead);

// The lane itself, on the host; for CUDA lanes the twin.   Throws: std::invalid_argument without either.
DecideBlock block_of(const Lane& lane);

// The lane's verdict: by the host, or for CUDA lanes by the twin.   Throws: std::invalid_argument without either.
Verdict decide_lane(const Lane& lane, const Pair& pair);

}  // namespace graze::analysis
