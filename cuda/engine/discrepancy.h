// SPDX-License-Identifier: Apache-2.0
// Compares the values of two lanes on a device, as core/discrepancy/count.h describes. This header includes no CUDA
// headers and compiles without nvcc.
#pragma once

#include <cstdint>
#include <span>

#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// Memory to which the counts are added. See DiscrepancyCounts in analysis/discrepancy.h.
struct DiscrepancySums {
  std::span<std::uint64_t> counts, maxima, unlike;
};

// Whether the lane's values can be recorded on a device: those of a published CUDA lane, and those of a host lane
// without contraction. For a host lane, the cuda-nofma kernels compute the values; count_different_runs checks them.
bool records_on_device(const Lane& lane);

// Compares both lanes on all pairs of the source.
// Requires: both lanes record on a device and have the same algorithm and scalar (double, for pairs of doubles).
// Throws: std::runtime_error on any CUDA error.
void count_discrepancies(const Lane& first, const Lane& second, const strata::PairSource& source,
                         const DiscrepancySums& to);

// The number of pairs on which a recorded value, choice or verdict differs in any bit between the host lane and the
// CUDA lane on the device.   Requires: as count_discrepancies; `host` is a host lane.
std::uint64_t count_different_runs(const Lane& host, const Lane& device, const strata::PairSource& source);

}  // namespace graze::cuda
