// SPDX-License-Identifier: Apache-2.0
// Finds the source lines at which a contracted CUDA lane's values begin to differ from those of the same source without
// contraction. Also finds how much a difference grows before it reaches a comparison, and which lines decide verdicts.
// The counts come from runs of the lane's twin in which only one line is fused, or all lines but one.
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "analysis/discrepancy.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {

// The contractions of one source line.
struct FusedLine {
  cuda::SourceLine at, from;                         // as in cuda::ContractionSite
  std::vector<std::uint64_t> mask, mask_of_doubles;  // its sites in the kernel of each coordinate type
  std::uint64_t values = 0;                          // fusing it alone changes this many values
  std::uint64_t verdicts_alone = 0;                  // fusing it alone changes this many verdicts
  // Verdicts that all contractions together change, and that rounding only this line's products restores.
  std::uint64_t verdicts_fixed = 0;
  std::optional<AnyPair> simplest;  // the simplest pair in the two counts above
};

// Counts of differing values by the line where the difference starts: the first line that makes the value differ when
// only that line is fused.
struct Start {
  std::vector<std::uint64_t> by_line;  // by line; the last entry counts values for which no single line suffices
  // growth[k]: values that the line's fusion moves by 2^k to 2^(k+1) ulps, while its own result moves by at most one.
  // Products, quotients and roots pass on a relative error; only sums whose terms cancel amplify it.
  std::array<std::uint64_t, 64> growth = {};
};

// Whether the first pair is simpler.
using Simpler = std::function<bool(const AnyPair&, const AnyPair&)>;

struct Origins {
  std::vector<FusedLine> lines;                 // in program order; those only in the kernel for doubles last
  std::map<std::pair<int, int>, Start> starts;  // by value: the number of its question, and 0 or 1
  std::uint64_t pairs = 0, verdicts = 0;        // pairs examined; those on which contraction changes the verdict
};

// Whether the lane has contractions whose lines are known.
bool has_origins(const Lane& lane);

// Examines the first `pairs` pairs of each source. `simpler` orders pairs for FusedLine::simplest.
// The result does not depend on the number of threads.   Requires: has_origins; sources of doubles only for a lane in
// double.
Origins origins(const Lane& lane, const std::vector<strata::PairSource>& sources, std::uint64_t pairs, int threads,
                const Simpler& simpler);

}  // namespace graze::analysis
