// SPDX-License-Identifier: Apache-2.0
// The on-device engine as the host sees it: pairs of a stratum are drawn, decided by lanes, judged exactly, measured
// and counted on a device; only counts and chosen cases come back. No CUDA header is needed here, nor nvcc to build.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/lanes.h"
#include "core/margin/bucket.h"

namespace graze::cuda {

inline constexpr int kEngineCases = 4;  // kept of each signature

// A signature in bits, lowest first: 24 of marks, 3 a lane of the algorithm, f32 then f64, each in the order of Target
// (0: did not run; 1: right; 2: false positive; 3: false negative; 4: declined); 8 of the bucket plus kBucketMost; 2 of
// each hull's dimension; 1: coplanar; 2 of the contact's dimension plus one; 4 of the algorithm, plus one.
using SignatureBits = std::uint64_t;

struct EngineSignature {
  SignatureBits bits = 0;
  std::uint64_t count = 0;
  std::uint64_t cases[kEngineCases] = {};  // the smallest indices; ~0 for none
};

// What a run found. Pairs whose bucket the device cannot decide are in `undecided`, and counted nowhere else.
struct EngineResult {
  std::uint64_t done = 0;  // pairs of the run: fewer than asked for when `undecided` was about to overflow
  // By bucket plus kBucketMost: pairs, intersecting ones, then of each lane: false positives, false negatives,
  // declined, differing from the cpu lane (always 0 here: no cpu lane runs).
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

  // Pairs [first, first + count) of the stratum (its place in kStrata).   Throws: std::runtime_error on any CUDA error.
  virtual EngineResult run(std::uint64_t seed, int stratum, std::uint64_t first, std::uint64_t count) = 0;
};

// An engine for each CUDA device.   Requires: CUDA lanes.   Returns: none without a device.
std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const> cuda_lanes);

}  // namespace graze::cuda
