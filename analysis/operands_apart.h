// SPDX-License-Identifier: Apache-2.0
// Compares the operands of comparisons in a user's CUDA source between runs with and without contraction, by source
// line. Both runs use the contracted lane's twin.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/twin/twin.h"
#include "strata/pair_source.h"

namespace graze::analysis {

// The comparisons on one source line. Two runs are compared up to the first comparison with different outcomes, because
// after it they may compare different values.
struct LineApart {
  cuda::SourceLine at, from;    // as in cuda::ComparisonSite
  std::uint64_t compared = 0;   // comparisons that both runs made
  std::uint64_t differs = 0;    // comparisons with an operand whose bits differ; the sum of the next four
  std::uint64_t zero_sign = 0;  // comparisons in which only signs of zeros differ
  std::uint64_t not_finite = 0;
  // Comparisons in which the operand that differs more is lower (higher) with contraction, by 2^k to 2^(k+1) ulps.
  std::array<std::uint64_t, 64> below = {}, above = {};
  std::uint64_t sign = 0;     // the sign of left minus right differs
  std::uint64_t outcome = 0;  // the outcomes differ
  std::uint64_t verdict = 0;  // the outcomes and the verdicts differ
};

struct OperandsApart {
  std::uint64_t pairs = 0, verdict = 0;  // finite pairs, and those with different verdicts
  std::vector<LineApart> lines;          // in program order
  std::string why_not;                   // why the runs failed; if set, there are no counts
};

// Whether the lanes run the same user's CUDA source, without and with contraction, and a twin shows its comparisons.
bool shows_operands(const Lane& rounded, const Lane& fused);

// Runs the first `pairs` pairs of each source in a separate process, because the code may crash or hang.
// Requires: shows_operands.
OperandsApart operands_apart(const Lane& fused, const std::vector<strata::PairSource>& sources, std::uint64_t pairs);

}  // namespace graze::analysis
