// SPDX-License-Identifier: Apache-2.0
// What lanes get wrong on a source's pairs, counted on a device: pairs are drawn and judged there once, then decided by
// each lane. No CUDA header is needed here, nor nvcc to build.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/counts.h"
#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// Of one lane. Pairs that are not finite are counted nowhere.
struct ErrorCounts : Counts {
  std::uint64_t fixed = 0, broken = 0;  // right, and the lane to compare with wrong or without an answer; or otherwise
  std::uint64_t first_fixed = ~std::uint64_t{0}, first_broken = ~std::uint64_t{0};  // indices; at first none
};

// Of each lane, on all pairs of the source.
// Requires: CUDA lanes, `zero` too.   Throws: std::runtime_error on any CUDA error.
std::vector<ErrorCounts> count_errors(const Lane& zero, std::span<const Lane> lanes, const strata::PairSource& source);

}  // namespace graze::cuda
