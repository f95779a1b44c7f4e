// SPDX-License-Identifier: Apache-2.0
// Memory bandwidth limits this kernel, so each warp prefetches tiles of triangles into shared memory with asynchronous
// copies. The reference's slabs decide most triangles. The others are queued until there are 32 of them or their tile
// is about to be overwritten; then the filter in floats decides them together. The filter leaves about one triangle in
// a hundred open, and the kernel lists those.
#include <cuda_pipeline_primitives.h>

#include <algorithm>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/query/device_rows.h"
#include "cuda/query/query_kernels.cuh"

namespace graze::cuda {
namespace {

using exact::detail::Finding;

constexpr std::uint32_t kEach = 4, kTile = 32 * kEach, kTileFloats = 9 * kTile;  // kEach: triangles per thread
// Shared memory has room for kStages tiles: prefetched tiles, the current tile, and a tile that may still have queued
// triangles.
constexpr std::uint32_t kAhead = 2, kKept = 1, kStages = kAhead + 1 + kKept, kQueue = 256, kUnsure = 64;
constexpr std::uint32_t kWarps = 6, kBlocks = 2;  // kBlocks: thread blocks that fit into a multiprocessor
constexpr std::uint32_t kAll = 0xffffffffu;

struct WarpMemory {
  alignas(16) float tile[kStages][kTileFloats];
  std::uint32_t hits[kStages][kEach];
  std::uint32_t unsure[kUnsure];
  std::uint16_t queue[kQueue];  // stage * kTile + index in the tile; first in, first out
};

// Starts fetching a tile. Triangles beyond the end of the chunk become zeros.
__device__ void fetch(const QueryChunk& chunk, bool by_vectors, std::uint32_t tile, float* to) {
  const std::uint32_t lane = threadIdx.x % 32;
  const std::uint64_t at = std::uint64_t{tile} * kTile;
  if (by_vectors && at + kTile <= chunk.count) {
    const auto* from = reinterpret_cast<const float4*>(chunk.array.rows + (chunk.first + at) * 36);
#pragma unroll
    for (std::uint32_t k = lane; k < kTileFloats / 4; k += 32) __pipeline_memcpy_async(to + 4 * k, from + k, 16);
  } else if (at < chunk.count) {
    for (std::uint32_t i = lane; i < kTile; i += 32) {
      float t[9] = {};
      if (at + i < chunk.count) chunk.array.load(chunk.first + at + i, t);
      for (int k = 0; k < 9; ++k) to[9 * i + k] = t[k];
    }
  }
  __pipeline_commit();
}

__device__ std::uint32_t lanes_before(std::uint32_t lanes) {
  return static_cast<std::uint32_t>(__popc(lanes & ((1u << threadIdx.x % 32) - 1)));
}

// Queues those triangles of a tile that the slabs leave open.   Returns: the queue's new end.
__device__ std::uint32_t queue_open(const exact::PreparedTriangle& reference, WarpMemory& warp, std::uint32_t stage,
                                    std::uint32_t end) {
  // Each thread reads nine vectors of 4 * kEach bytes. Because nine is odd, no two threads read from one bank at once.
  struct alignas(4 * kEach) Vector {
    float v[kEach];
  };
  const std::uint32_t lane = threadIdx.x % 32;
  alignas(Vector) float t[9 * kEach];
#pragma unroll
  for (int k = 0; k < 9; ++k)
    reinterpret_cast<Vector*>(t)[k] = reinterpret_cast<const Vector*>(warp.tile[stage])[9 * lane + k];
  bool open[kEach];
#pragma unroll
  for (std::uint32_t j = 0; j < kEach; ++j) open[j] = !exact::is_beyond(reference, t + 9 * j);
#pragma unroll
  for (std::uint32_t j = 0; j < kEach; ++j) {
    const std::uint32_t all = __ballot_sync(kAll, open[j]);
    if (open[j]) {
      warp.queue[(end + lanes_before(all)) % kQueue] = static_cast<std::uint16_t>(stage * kTile + kEach * lane + j);
    }
    end += static_cast<std::uint32_t>(__popc(all));
  }
  return end;
}

// Moves the last `count` unsure triangles to the list.
__device__ void list(const WarpMemory& warp, std::uint32_t unsure, std::uint32_t count, PairList left) {
  const std::uint32_t lane = threadIdx.x % 32;
  std::uint32_t first = 0;
  if (lane == 0) first = atomicAdd(left.count, count);
  first = __shfl_sync(kAll, first, 0);
  if (lane < count) left.at[first + lane] = warp.unsure[unsure - count + lane];
}

// Writes the hits of a tile and clears them.
__device__ void give(WarpMemory& warp, std::uint32_t stage, std::uint32_t tile, std::uint32_t* hits) {
  const std::uint32_t lane = threadIdx.x % 32;
  if (lane >= kEach) return;
  hits[tile * kEach + lane] = warp.hits[stage][lane];
  warp.hits[stage][lane] = 0;
}

__global__ void __launch_bounds__(kWarps * 32, kBlocks)
    decide_by_slabs(const __grid_constant__ exact::PreparedTriangle reference, const __grid_constant__ QueryChunk chunk,
                    bool by_vectors, PairList left, std::uint32_t* hits) {
  extern __shared__ float4 shared[];
  WarpMemory& warp = reinterpret_cast<WarpMemory*>(shared)[threadIdx.x / 32];
  const std::uint32_t lane = threadIdx.x % 32, step = gridDim.x * kWarps, tiles = (chunk.count + kTile - 1) / kTile;
  std::uint32_t tile = blockIdx.x * kWarps + threadIdx.x / 32;
  if (tile >= tiles) return;
  for (std::uint32_t k = 0; k < kAhead; ++k) fetch(chunk, by_vectors, tile + k * step, warp.tile[k]);
  if (lane < kStages * kEach) warp.hits[0][lane] = 0;
  std::uint32_t begin = 0, end = 0, unsure = 0, done = 0, due[kKept + 1] = {};  // due[k]: the queue's end k tiles ago
  for (;; tile += step, ++done) {
    const std::uint32_t stage = done % kStages;
    fetch(chunk, by_vectors, tile + kAhead * step, warp.tile[(stage + kAhead) % kStages]);
    __pipeline_wait_prior(kAhead);
    __syncwarp();
    for (std::uint32_t k = kKept; k > 1; --k) due[k] = due[k - 1];
    due[1] = end;  // triangles queued kKept tiles ago are due: the next fetch overwrites their tile
    end = queue_open(reference, warp, stage, end);
    const bool last = tile + step >= tiles;
    __syncwarp();
    while (end - begin >= 32 || begin < due[kKept] || (last && begin < end)) {
      const bool some = begin + lane < end;
      const std::uint32_t entry = warp.queue[(some ? begin + lane : begin) % kQueue];
      const Finding found = exact::detail::filter_in_floats(reference, warp.tile[0] + 9 * entry);
      if (some && found == Finding::crosses) atomicOr(&warp.hits[0][entry / 32], 1u << entry % 32);
      const std::uint32_t age = (stage + kStages - entry / kTile) % kStages;
      const std::uint32_t i = (tile - age * step) * kTile + entry % kTile;
      const bool is_unsure = some && found == Finding::unsure && i < chunk.count;
      const std::uint32_t all_unsure = __ballot_sync(kAll, is_unsure);
      if (is_unsure) warp.unsure[unsure + lanes_before(all_unsure)] = i;
      unsure += static_cast<std::uint32_t>(__popc(all_unsure));
      begin = min(begin + 32, end);
      __syncwarp();
      if (unsure >= 32) {
        list(warp, unsure, 32, left);
        unsure -= 32;
        __syncwarp();
      }
    }
    if (last) break;
    if (done >= kKept) give(warp, (stage + kAhead + 1) % kStages, tile - kKept * step, hits);
    __syncwarp();
  }
  for (std::uint32_t age = 0; age <= min(kKept, done); ++age)
    give(warp, (done + kStages - age) % kStages, tile - age * step, hits);
  if (unsure > 0) list(warp, unsure, unsure, left);
}

constexpr int kMemory = kWarps * sizeof(WarpMemory);

}  // namespace

KernelNeeds needs_of_exact_query(int device) {
  check(cudaSetDevice(device));
  check(cudaFuncSetAttribute(decide_by_slabs, cudaFuncAttributeMaxDynamicSharedMemorySize, kMemory));
  cudaFuncAttributes attributes;
  check(cudaFuncGetAttributes(&attributes, decide_by_slabs));
  int blocks = 0;
  constexpr int kThreads = kWarps * 32;
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, decide_by_slabs, kThreads, kMemory));
  return {kThreads, attributes.numRegs, static_cast<int>(attributes.localSizeBytes), blocks * kThreads};
}

void launch_slabs(const exact::PreparedTriangle& reference, const QueryChunk& chunk, PairList left, std::uint32_t* hits,
                  cudaStream_t stream) {
  int device = 0, processors = 0;
  check(cudaGetDevice(&device));
  check(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device));
  const bool by_vectors = chunk.array.packed(sizeof(float)) && chunk.first % 4 == 0 &&
                          reinterpret_cast<std::uintptr_t>(chunk.array.rows) % 16 == 0;
  const std::uint32_t tiles = (chunk.count + kTile - 1) / kTile, wanted = (tiles + kWarps - 1) / kWarps;
  const std::uint32_t blocks = std::min(wanted, static_cast<std::uint32_t>(processors) * kBlocks);
  if (const std::size_t behind = row_words(chunk.count) - tiles * kEach; behind > 0)
    check(cudaMemsetAsync(hits + tiles * kEach, 0, behind * sizeof *hits, stream));
  check(cudaFuncSetAttribute(decide_by_slabs, cudaFuncAttributeMaxDynamicSharedMemorySize, kMemory));
  decide_by_slabs<<<blocks, kWarps * 32, kMemory, stream>>>(reference, chunk, by_vectors, left, hits);
  check(cudaGetLastError());
}

}  // namespace graze::cuda
