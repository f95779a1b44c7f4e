// SPDX-License-Identifier: Apache-2.0
// A warp takes tiles of 32 triangles, which it fetches ahead into shared memory by asynchronous copies: the memory's
// speed bounds all of this. The slabs of the reference decide most triangles; those that they leave open gather in a
// queue of the warp until there are 32, which the screen in floats then decides together; what that leaves, one in a
// hundred or so, is listed for the screen in doubles and the steps of the exact decision.
#include "cuda/query/query_kernels.cuh"

#include <cuda_pipeline_primitives.h>

#include "cuda/lanes/exact_steps.cuh"

namespace graze::cuda {
namespace {

constexpr int kWarps = 4, kStages = 4, kTile = 32, kTileFloats = 9 * kTile, kQueue = 2 * kTile;
constexpr int kBlocks = 7;  // of a multiprocessor, which has shared memory for so many

struct WarpMemory {
  alignas(16) float tile[kStages][kTileFloats];
  float queued[9][kQueue];
  std::uint32_t place[kQueue];
};

// How the steps of the exact decision read a pair.
struct QueryPairs {
  exact::Reference reference;
  QueryChunk chunk;
};

__device__ void load(const QueryPairs& pairs, std::uint32_t i, float* c) {
  for (int k = 0; k < 9; ++k) c[k] = pairs.reference.v[k];
  pairs.chunk.array.load(pairs.chunk.first + i, c + 9);
}

// Starts to fetch the tile; nothing where it lies beyond the end.
__device__ void fetch(const QueryChunk& chunk, bool by_vectors, std::uint32_t tile, float* to) {
  const std::uint32_t lane = threadIdx.x % 32;
  const std::uint64_t at = std::uint64_t{tile} * kTile;
  if (by_vectors && at + kTile <= chunk.count) {
    const auto* from = reinterpret_cast<const float4*>(chunk.array.rows + (chunk.first + at) * 36);
    for (std::uint32_t k = lane; k < kTileFloats / 4; k += 32) __pipeline_memcpy_async(to + 4 * k, from + k, 16);
  } else if (at + lane < chunk.count) {
    float t[9];
    chunk.array.load(chunk.first + at + lane, t);
    for (int k = 0; k < 9; ++k) to[9 * lane + k] = t[k];
  }
  __pipeline_commit();
}

// The screen in floats for one queued triangle of each thread.
__device__ void decide_queued(const exact::Reference& reference, const WarpMemory& warp, std::uint32_t slot,
                              Places left, std::uint32_t* hits) {
  float t[9];
  for (int k = 0; k < 9; ++k) t[k] = warp.queued[k][slot];
  const Finding found = exact::detail::screen_in_floats(reference, t);
  if (found == Finding::crosses) set_bit(hits, warp.place[slot]);
  if (found == Finding::unsure) left.add(warp.place[slot]);
}

__global__ void __launch_bounds__(kWarps * 32, kBlocks)
    decide_chunk(const __grid_constant__ QueryPairs pairs, bool by_vectors, Places left, std::uint32_t* hits,
                 std::uint32_t* declined) {
  __shared__ WarpMemory memory[kWarps];
  WarpMemory& warp = memory[threadIdx.x / 32];
  const QueryChunk& chunk = pairs.chunk;
  const std::uint32_t lane = threadIdx.x % 32, step = gridDim.x * kWarps, tiles = (chunk.count + kTile - 1) / kTile;
  std::uint32_t ahead = blockIdx.x * kWarps + threadIdx.x / 32, queued = 0;
  for (int stage = 0; stage < kStages - 1; ++stage, ahead += step) fetch(chunk, by_vectors, ahead, warp.tile[stage]);
  int stage = 0;
  for (std::uint32_t tile = blockIdx.x * kWarps + threadIdx.x / 32; tile < tiles; tile += step, ahead += step) {
    fetch(chunk, by_vectors, ahead, warp.tile[(stage + kStages - 1) % kStages]);
    __pipeline_wait_prior(kStages - 1);
    __syncwarp();
    const std::uint32_t i = tile * kTile + lane;
    float t[9];
    for (int k = 0; k < 9; ++k) t[k] = warp.tile[stage][9 * lane + k];
    const exact::Sight sight = i < chunk.count ? exact::look_past(pairs.reference, t) : exact::Sight::beyond;
    const std::uint32_t open = __ballot_sync(0xffffffffu, sight == exact::Sight::open);
    const std::uint32_t not_finite = __ballot_sync(0xffffffffu, sight == exact::Sight::not_finite);
    if (lane == 0) {
      declined[tile] = not_finite;
      hits[tile] = 0;
    }
    if (sight == exact::Sight::open) {
      const std::uint32_t slot = queued + static_cast<std::uint32_t>(__popc(open & ((1u << lane) - 1)));
      for (int k = 0; k < 9; ++k) warp.queued[k][slot] = t[k];
      warp.place[slot] = i;
    }
    queued += static_cast<std::uint32_t>(__popc(open));
    __syncwarp();
    if (queued >= kTile) {
      queued -= kTile;
      decide_queued(pairs.reference, warp, queued + lane, left, hits);
      __syncwarp();
    }
    stage = (stage + 1) % kStages;
  }
  if (lane < queued) decide_queued(pairs.reference, warp, lane, left, hits);
}

// The screen in doubles for those that were listed.
__global__ void __launch_bounds__(kThreads, 3)
    screen_listed(const __grid_constant__ QueryPairs pairs, Places from, Places left, std::uint32_t* hits) {
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Finding found = exact::detail::screen(c, c + 9);
    if (found == Finding::crosses || (found == Finding::unsure && exact::detail::shared_vertex(c, c + 9) >= 0)) {
      set_bit(hits, i);
    } else if (found == Finding::unsure) {
      left.add(i);
    }
  }
}

__global__ void __launch_bounds__(kThreads)
    pair_up(const __grid_constant__ QueryPairs pairs, std::uint32_t stride, float* columns, std::uint32_t* not_finite) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  if (i < pairs.chunk.count) {
    float c[kCoordinates];
    load(pairs, i, c);
    for (int k = 0; k < kCoordinates; ++k) {
      finite = finite && is_finite(c[k]);
      columns[std::size_t(k) * stride + i] = c[k];
    }
  }
  const std::uint32_t word = __ballot_sync(0xffffffffu, !finite);
  if (threadIdx.x % 32 == 0) not_finite[i / 32] = word;
}

__global__ void __launch_bounds__(kThreads)
    decline(std::uint32_t words, const std::uint32_t* not_finite, std::uint32_t* hits, std::uint32_t* declined) {
  const std::uint32_t w = blockIdx.x * kThreads + threadIdx.x;
  if (w >= words) return;
  declined[w] |= not_finite[w];
  hits[w] &= ~declined[w];
}

__global__ void __launch_bounds__(kThreads)
    count_bits(std::uint32_t words, const std::uint32_t* hits, const std::uint32_t* declined, QueryCounts* counts) {
  unsigned found = 0, without = 0, first = 0xffffffffu;
  for (std::uint32_t w = blockIdx.x * kThreads + threadIdx.x; w < words; w += gridDim.x * kThreads) {
    found += static_cast<unsigned>(__popc(hits[w]));
    without += static_cast<unsigned>(__popc(declined[w]));
    if (hits[w]) first = min(first, w * 32 + static_cast<unsigned>(__ffs(static_cast<int>(hits[w]))) - 1);
  }
  for (int far = 16; far > 0; far /= 2) {
    found += __shfl_xor_sync(0xffffffffu, found, far);
    without += __shfl_xor_sync(0xffffffffu, without, far);
    first = min(first, __shfl_xor_sync(0xffffffffu, first, far));
  }
  if (threadIdx.x % 32 != 0) return;
  using Long = unsigned long long;
  if (found) atomicAdd(reinterpret_cast<Long*>(&counts->hits), Long{found});
  if (without) atomicAdd(reinterpret_cast<Long*>(&counts->declined), Long{without});
  if (found) atomicMin(reinterpret_cast<Long*>(&counts->first), Long{first});
}

__global__ void __launch_bounds__(kThreads)
    forget_behind(std::uint32_t words, const std::uint32_t* declined, QueryCounts* counts, std::uint32_t rows) {
  std::uint64_t first = ~std::uint64_t{0};
  for (std::uint32_t r = 0; r < rows; ++r) first = min(first, counts[r].first);
  const std::uint64_t w = blockIdx.x * kThreads + threadIdx.x;
  if (w >= words || w < first / 32) return;
  const std::uint32_t behind = w > first / 32 ? 0xffffffffu : ~((1u << first % 32) - 1);
  const int forgotten = __popc(declined[w] & behind);
  if (forgotten != 0)
    atomicAdd(reinterpret_cast<unsigned long long*>(&counts->declined), static_cast<unsigned long long>(-forgotten));
}

__global__ void __launch_bounds__(kThreads)
    write_bytes(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, unsigned char* bytes) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  if (i >= count) return;
  const std::uint32_t hit = hits[i / 32] >> i % 32 & 1, no_answer = declined[i / 32] >> i % 32 & 1;
  bytes[i] = static_cast<unsigned char>(hit | no_answer << 1);
}

std::uint32_t blocks_for(std::uint32_t things) { return (things + kThreads - 1) / kThreads; }

}  // namespace

void launch_exact_query(const exact::Reference& reference, const QueryChunk& chunk, std::uint32_t* lists,
                        std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined, cudaStream_t stream) {
  check(cudaMemsetAsync(counts, 0, kQueryLists * sizeof *counts, stream));
  int device = 0, processors = 0;
  check(cudaGetDevice(&device));
  check(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device));
  const bool by_vectors =
      chunk.array.packed() && chunk.first % 4 == 0 && reinterpret_cast<std::uintptr_t>(chunk.array.rows) % 16 == 0;
  const std::uint32_t tiles = (chunk.count + kTile - 1) / kTile, wanted = (tiles + kWarps - 1) / kWarps;
  const std::uint32_t blocks = std::min(wanted, static_cast<std::uint32_t>(processors) * kBlocks);
  if (const std::size_t behind = (row_words(chunk.count) - tiles) * sizeof *hits; behind > 0) {
    check(cudaMemsetAsync(hits + tiles, 0, behind, stream));
    check(cudaMemsetAsync(declined + tiles, 0, behind, stream));
  }
  const QueryPairs pairs{reference, chunk};
  // Each list takes the memory of the one before the last, which nobody needs any more.
  Places left[kQueryLists];
  for (std::uint32_t k = 0; k < kQueryLists; ++k) left[k] = {lists + (k % 2) * chunk.count, counts + k};
  decide_chunk<<<blocks, kWarps * 32, 0, stream>>>(pairs, by_vectors, left[0], hits, declined);
  check(cudaGetLastError());
  screen_listed<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[0], left[1], hits);
  launch_exact_steps(pairs, left[1], left[2], left[3], hits, nullptr, stream);
}

void launch_pair_up(const exact::Reference& reference, const QueryChunk& chunk, float* columns,
                    std::uint32_t* not_finite, cudaStream_t stream) {
  pair_up<<<blocks_for(chunk.count), kThreads, 0, stream>>>({reference, chunk}, row_words(chunk.count) * 32, columns,
                                                            not_finite);
  check(cudaGetLastError());
}

void launch_decline(std::uint32_t words, const std::uint32_t* not_finite, std::uint32_t* hits, std::uint32_t* declined,
                    cudaStream_t stream) {
  decline<<<blocks_for(words), kThreads, 0, stream>>>(words, not_finite, hits, declined);
  check(cudaGetLastError());
}

void launch_count(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, QueryCounts* counts,
                  cudaStream_t stream) {
  const std::uint32_t words = (count + 31) / 32;
  count_bits<<<std::min(blocks_for(words), 512u), kThreads, 0, stream>>>(words, hits, declined, counts);
  check(cudaGetLastError());
}

void launch_forget_behind(std::uint32_t count, const std::uint32_t* declined, QueryCounts* counts, std::uint32_t rows,
                          cudaStream_t stream) {
  const std::uint32_t words = (count + 31) / 32;
  forget_behind<<<blocks_for(words), kThreads, 0, stream>>>(words, declined, counts, rows);
  check(cudaGetLastError());
}

void launch_bytes(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, unsigned char* bytes,
                  cudaStream_t stream) {
  write_bytes<<<blocks_for(count), kThreads, 0, stream>>>(count, hits, declined, bytes);
  check(cudaGetLastError());
}

}  // namespace graze::cuda
