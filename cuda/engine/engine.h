// SPDX-License-Identifier: Apache-2.0
// The on-device engine as the host sees it: pairs are drawn (those of a stratum, with a scene or without) or brought,
// decided by lanes, judged exactly, measured and counted on a device; only counts and chosen cases come back. No CUDA
// header is needed here, nor nvcc to build.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/margin/bucket.h"
#include "core/verdict.h"
#include "strata/pair_source.h"

namespace graze::cuda {

inline constexpr int kEngineCases = 4;  // kept of each signature

// A run of lanes of one subject: lanes [first, first + count) of the engine's.
struct LaneGroup {
  std::uint32_t first, count;
};

// The groups of these lanes; exact lanes, which have no failures, are in none.   Requires: lanes in table order.
std::vector<LaneGroup> lane_groups(std::span<const Lane* const> lanes);

// One subject's failure, and the pairs that fail so.
struct EngineSignature {
  Relation relation;
  Bucket bucket = 0;
  LaneGroup lanes{};
  std::vector<Verdict> verdicts;  // of each lane of the group
  std::uint64_t count = 0;
  std::vector<std::uint64_t> cases;  // the smallest indices, sorted, at most kEngineCases
};

// What a run found. Pairs whose bucket the device cannot decide are in `undecided`, and counted nowhere else.
struct EngineResult {
  std::uint64_t done = 0;  // pairs of the run: fewer than asked for when `undecided` was about to overflow
  // By bucket plus kBucketMost: pairs, intersecting ones, then of each lane: false positives, false negatives,
  // declined.
  std::vector<std::uint64_t> counts;
  std::vector<std::uint64_t> extreme_counts;  // the same by place_on_axis plus kBucketMost; empty without an axis
  std::vector<EngineSignature> signatures;
  std::vector<std::uint64_t> undecided;  // indices, sorted
  std::uint64_t disagreements = 0;
};

// One device. One thread at a time.
class DeviceEngine {
 public:
  virtual ~DeviceEngine() = default;

  // Pairs [first, first + count) of the source.   Requires: they are finite.
  // Throws: std::runtime_error on any CUDA error, and when signatures or undecided pairs outgrow their memory.
  virtual EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) = 0;
};

// An engine for each CUDA device.   Requires: CUDA lanes.   Returns: none without a device.
std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const> cuda_lanes);

}  // namespace graze::cuda
