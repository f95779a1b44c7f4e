// SPDX-License-Identifier: Apache-2.0
// Counts the errors of lanes on a device. The source's pairs are drawn and exactly decided only once; then each lane
// decides them. This header includes no CUDA headers and compiles without nvcc.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/counts.h"
#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// The counts of one lane. Pairs with a coordinate that is not finite are not counted.
struct ErrorCounts : Counts {
  // fixed: pairs on which the lane is right and `zero` is wrong or declines. broken: the reverse.
  std::uint64_t fixed = 0, broken = 0;
  std::uint64_t first_fixed = ~std::uint64_t{0}, first_broken = ~std::uint64_t{0};  // the first index; ~0: none
};

// Each lane's counts over all pairs of the source, compared with the lane `zero`. On pairs of doubles, lanes in float
// decide the pairs rounded to float32.
// Requires: CUDA lanes, including `zero`.   Throws: std::runtime_error on any CUDA error.
std::vector<ErrorCounts> count_errors(const Lane& zero, std::span<const Lane> lanes, const strata::PairSource& source);

}  // namespace graze::cuda
