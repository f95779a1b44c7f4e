// SPDX-License-Identifier: Apache-2.0
// Compares the values of two lanes on a device, as core/discrepancy/count.h describes. This header needs no CUDA
// header, and building it needs no nvcc.
#pragma once

#include <cstdint>
#include <span>

#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// The memory to which counts are added; see DiscrepancyCounts in analysis/discrepancy.h.
struct DiscrepancySums {
  std::span<std::uint64_t> counts, maxima, unlike;
};

// Whether the lane's values can be recorded on a device: a published CUDA lane that is built, or a host lane without
// contraction. The kernels of cuda-nofma compute a host lane's values; count_different_runs checks them.
bool records_on_device(const Lane& lane);

// Compares both lanes on all pairs of the source. Pairs of doubles are drawn by all CPU cores.
// Requires: records_on_device of both; the algorithm and the scalar are the same, in double for a source of doubles.
// Throws: std::runtime_error on any CUDA error.
void count_discrepancies(const Lane& first, const Lane& second, const strata::PairSource& source,
                         const DiscrepancySums& to);

// The number of pairs on which any recorded value, choice or verdict of the host lane differs in any bit from that of
// the CUDA lane on the device.   Requires: as above; `host` is a host lane.
std::uint64_t count_different_runs(const Lane& host, const Lane& device, const strata::PairSource& source);

}  // namespace graze::cuda
