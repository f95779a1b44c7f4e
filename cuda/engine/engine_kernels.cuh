// SPDX-License-Identifier: Apache-2.0
// The engine's kernels: margins, relations, signatures and counts of one block of pairs. Device code only.
#pragma once

#include <cuda_runtime.h>

#include "core/margin/axis.h"
#include "cuda/engine/engine.h"
#include "cuda/lanes/exact_kernels.cuh"

namespace graze::cuda {

inline constexpr std::int8_t kUndecided = 127;  // a bucket, or an extreme, that is not known
inline constexpr int kMostLanes = 32;

struct LaneWords {
  const std::uint32_t *intersects, *declined;
  int algorithm, slot;  // place of the lane's mark in a signature; -1 for exact lanes
};

struct LaneTable {
  int count;
  LaneWords lane[kMostLanes];
};

// Signatures by open addressing; bits 0: free.
struct SignatureTable {
  EngineSignature* rows;
  std::uint32_t size;  // a power of two
  std::uint32_t* full;
};

// Indices of pairs for the host; `count` goes on past `size`.
struct IndexList {
  std::uint64_t* indices;
  std::uint32_t size;
  std::uint32_t* count;
};

// Pairs whose bucket single precision left open, disjoint ones and intersecting ones; disjoint ones that double left
// open as well; those that need their relation; of these the ones that need all axes, by the numbers that hold them;
// and intersecting ones that double left open although their margin is not zero.
enum EngineList {
  kOpenGaps,
  kOpenDepths,
  kTies,
  kRelated,
  kByDoubles,
  kByNarrow,
  kByInts,
  kByLong,
  kByWide,
  kDepths,
  kEngineLists
};

struct EngineBlock {
  DevicePairs pairs;
  std::uint64_t first;  // index of the block's first pair
  const std::uint32_t* truth;
  std::uint32_t* wrong;  // pairs on which some lane is
  std::int8_t* buckets;
  LaneTable lanes;
  Places lists[kEngineLists];
  SignatureTable signatures;
  IndexList undecided;
  unsigned long long* counts;  // see EngineResult
  Axis axis;
  std::int8_t* extremes;  // written and counted unless axis is none
  unsigned long long* extreme_counts;
  unsigned long long* disagreements;
};

GRAZE_HD constexpr std::size_t engine_counters(int lanes) {
  return (2 + 4 * static_cast<std::size_t>(lanes)) * kBucketCount;
}

// Requires: truth and the lanes' words are written, the lists of places are empty.
void launch_engine(const EngineBlock& block, cudaStream_t stream);

}  // namespace graze::cuda
