// SPDX-License-Identifier: Apache-2.0
// Counts the errors of lanes on a device. The pairs of a source are drawn and judged once, then decided by each lane.
// This header needs no CUDA header, and building it needs no nvcc.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/counts.h"
#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// The counts of one lane. Pairs that are not finite are not counted.
struct ErrorCounts : Counts {
  std::uint64_t fixed = 0, broken = 0;  // fixed: right where `zero` is wrong or declines; broken: the converse
  std::uint64_t first_fixed = ~std::uint64_t{0}, first_broken = ~std::uint64_t{0};  // first index, or ~0
};

// Counts for each lane over all pairs of the source. `zero` is the lane to compare with. Lanes in float decide pairs of
// doubles as float32 stores them.
// Requires: CUDA lanes, including `zero`.   Throws: std::runtime_error on any CUDA error.
std::vector<ErrorCounts> count_errors(const Lane& zero, std::span<const Lane> lanes, const strata::PairSource& source);

}  // namespace graze::cuda
