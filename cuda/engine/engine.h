// SPDX-License-Identifier: Apache-2.0
// The engine on a device, as the host sees it. The device draws pairs of a stratum, with or without a scene, or takes
// pairs from the host. It decides them with the lanes, judges them exactly, and measures and counts them. Only counts
// and chosen cases come back. This header needs no CUDA header, and building it needs no nvcc.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/exact/nesting.h"
#include "core/lanes/lanes.h"
#include "core/margin/bucket.h"
#include "core/verdict.h"
#include "strata/pair_source.h"

namespace graze::cuda {

inline constexpr int kEngineCases = 4;  // kept for each signature

// Consecutive lanes of one subject: the engine's lanes [first, first + count).
struct LaneGroup {
  std::uint32_t first, count;
};

// The groups of these lanes. On pairs of float32, exact lanes never fail, so they are in no group. On doubles, exact
// lanes of float32 fail where storing a pair changes its verdict.   Requires: lanes in table order.
std::vector<LaneGroup> lane_groups(std::span<const Lane* const> lanes, bool of_doubles = false);

// The number of counters of each lane in an EngineResult.
constexpr std::uint32_t counters_of_lane(bool of_doubles) { return of_doubles ? 4 : 3; }

// The signature of one subject's failures, and the pairs that have it.
struct EngineSignature {
  Relation relation;
  Nesting nesting = Nesting::none;
  Bucket bucket = 0;
  LaneGroup lanes{};
  std::vector<Verdict> verdicts;  // of each lane of the group
  std::uint64_t count = 0;
  std::vector<std::uint64_t> cases;  // the smallest indices, sorted, at most kEngineCases
};

// The result of a run. Pairs whose bucket the device cannot decide are listed in `undecided` and counted nowhere else.
struct EngineResult {
  std::uint64_t done = 0;  // pairs judged; fewer than requested when `undecided` was about to overflow
  // Indexed by bucket + kBucketMost. In order: pairs; intersecting pairs; then for each lane its false positives, false
  // negatives and declined pairs, and on doubles its wrong verdicts counted as `stored` (analysis/tally.h).
  std::vector<std::uint64_t> counts;
  std::vector<std::uint64_t> extreme_counts;  // same, by place_on_axis + kBucketMost; empty without an axis
  std::vector<EngineSignature> signatures;
  std::vector<std::uint64_t> undecided;  // indices, sorted
  std::uint64_t disagreements = 0;
};

// One device. Not thread-safe.
class DeviceEngine {
 public:
  virtual ~DeviceEngine() = default;

  // Judges pairs [first, first + count) of the source.   Requires: finite pairs.
  // Throws: std::runtime_error on any CUDA error, or when signatures or undecided pairs exceed their memory.
  virtual EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) = 0;
};

// An engine for each CUDA device; none without a device.   Requires: CUDA lanes.
std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const> cuda_lanes);

}  // namespace graze::cuda
