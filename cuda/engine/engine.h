// SPDX-License-Identifier: Apache-2.0
// The host's interface to the engine on a device. The device draws pairs of a stratum, with or without a scene, or
// takes pairs from the host. The lanes and the exact decision decide the pairs; the engine measures and counts
// them, and returns only counts and chosen cases. This header includes no CUDA headers and compiles without nvcc.
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

inline constexpr int kEngineCases = 4;  // cases kept for each signature

// A group of consecutive lanes of one subject: the engine's lanes [first, first + count).
struct LaneGroup {
  std::uint32_t first, count;
};

// The groups of these lanes. On float32 pairs, exact lanes never fail, so they are in no group. On doubles, an exact
// float32 lane fails if storing the pair as float32 changes its verdict.   Requires: lanes in the order of lanes().
std::vector<LaneGroup> lane_groups(std::span<const Lane* const> lanes, bool of_doubles = false);

// The number of counters that each lane has in an EngineResult.
constexpr std::uint32_t counters_of_lane(bool of_doubles) { return of_doubles ? 4 : 3; }

// A signature of a subject's failures, and the pairs that have it.
struct EngineSignature {
  Relation relation;
  Nesting nesting = Nesting::none;
  Bucket bucket = 0;
  LaneGroup lanes{};
  std::vector<Verdict> verdicts;  // one for each lane of the group
  std::uint64_t count = 0;
  std::vector<std::uint64_t> cases;  // the smallest indices of these pairs, sorted, at most kEngineCases
};

// The result of a run. If the device cannot decide a pair's bucket, `undecided` lists the pair, and counts exclude it.
struct EngineResult {
  std::uint64_t done = 0;  // pairs judged; fewer than requested if `undecided` might have overflowed
  // Arrays of counters, each indexed by bucket + kBucketMost: pairs, intersecting pairs, then each lane's false
  // positives, false negatives and declined pairs. For doubles, also each lane's wrong verdicts with the cause
  // `stored` (analysis/tally.h).
  std::vector<std::uint64_t> counts;
  std::vector<std::uint64_t> extreme_counts;  // counters by place_on_axis + kBucketMost; empty without an axis
  std::vector<EngineSignature> signatures;
  std::vector<std::uint64_t> undecided;  // indices of pairs, sorted
  std::uint64_t disagreements = 0;
};

// The engine on one device. Not thread-safe.
class DeviceEngine {
 public:
  virtual ~DeviceEngine() = default;

  // Judges pairs [first, first + count) of the source.   Requires: finite pairs.
  // Throws: std::runtime_error on any CUDA error, or when signatures or undecided pairs exceed their memory.
  virtual EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) = 0;
};

// One engine for each CUDA device; empty without a device.   Requires: CUDA lanes.
std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const> cuda_lanes);

}  // namespace graze::cuda
