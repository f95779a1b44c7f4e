// SPDX-License-Identifier: Apache-2.0
// Compares the values of two lanes on a device, as core/discrepancy/count.h describes. This header includes no CUDA
// header, and compiles without nvcc.
#pragma once

#include <cstdint>
#include <span>

#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// The memory of the counts; new counts are added. See DiscrepancyCounts in analysis/discrepancy.h.
struct DiscrepancySums {
  std::span<std::uint64_t> counts, maxima, unlike;
};

// Whether the lane's values can be recorded on a device. They can be for a published CUDA lane, and for a host lane
// without contraction. The kernels of cuda-nofma compute a host lane's values; count_different_runs checks these
// values.
bool records_on_device(const Lane& lane);

// Compares both lanes on all pairs of the source.
// Requires: records_on_device of both lanes, which have the same algorithm and scalar; lanes in double for doubles.
// Throws: std::runtime_error on any CUDA error.
void count_discrepancies(const Lane& first, const Lane& second, const strata::PairSource& source,
                         const DiscrepancySums& to);

// The number of pairs on which a recorded value, choice or verdict of the host lane has other bits than the CUDA lane's
// on the device.   Requires: as count_discrepancies; `host` is a host lane.
std::uint64_t count_different_runs(const Lane& host, const Lane& device, const strata::PairSource& source);

}  // namespace graze::cuda
