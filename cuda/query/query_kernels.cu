// SPDX-License-Identifier: Apache-2.0
// A query's steps after the slabs: pairs on small grids, the filter in doubles, and the exact decision. Another kernel
// in this file writes the pairs for other lanes.
#include "cuda/query/query_kernels.cuh"

#include <algorithm>

#include "cuda/lanes/exact_steps.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {
namespace {

// The reference paired with each triangle, in the form that the steps of the exact decision read.
struct QueryPairs {
  using Real = float;
  exact::PreparedTriangle reference;
  QueryChunk chunk;
};

__device__ void load(const QueryPairs& pairs, std::uint32_t i, float* c) {
  for (int k = 0; k < 9; ++k) c[k] = pairs.reference.v[k];
  pairs.chunk.array.load(pairs.chunk.first + i, c + 9);
}

// Decides the listed triangles whose grid is small, as is common for touching triangles. Declines triangles with a
// coordinate that is not finite.
__global__ void __launch_bounds__(kThreads, 2)
    decide_on_grid(const __grid_constant__ QueryPairs pairs, PairList from, PairList left, std::uint32_t* hits,
                   std::uint32_t* declined) {
  using Numbers = exact::detail::ResidueNumbers;
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    bool finite = true;
    for (int k = 0; k < kCoordinates; ++k) finite = finite && is_finite(c[k]);
    const Grid grid = exact::detail::grid_of(c, c + 9);
    if (!finite) {
      set_bit(declined, i);
    } else if (exact::detail::shared_vertex(c, c + 9) >= 0) {
      set_bit(hits, i);
    } else if (!Numbers::holds(grid)) {
      left.add(i);
    } else if (exact::detail::decide<Numbers>(c, c + 9, grid.exponent)) {
      set_bit(hits, i);
    }
  }
}

// Runs the filter in doubles on the triangles that decide_on_grid leaves open.
__global__ void __launch_bounds__(kThreads, 3)
    filter_listed(const __grid_constant__ QueryPairs pairs, PairList from, PairList left, std::uint32_t* hits) {
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Finding found = exact::detail::filter(c, c + 9);
    if (found == Finding::crosses) set_bit(hits, i);
    if (found == Finding::unsure) left.add(i);
  }
}

// Tests triangles of doubles, relative to the reference's first vertex, against the reference's slabs. Lists the
// triangles that no slab excludes.
__global__ void __launch_bounds__(kThreads)
    decide_doubles_by_slabs(const __grid_constant__ exact::PreparedTriangle seen,
                            const __grid_constant__ ArrayPairs pairs, std::uint32_t count, PairList left,
                            std::uint32_t* hits, std::uint32_t* declined) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool open = false, finite = true;
  if (i < count) {
    double c[kCoordinates];
    load(pairs, i, c);
    float differences[9];
    for (int k = 0; k < 9; ++k) differences[k] = static_cast<float>(c[9 + k] - c[k % 3]);
    open = !exact::is_beyond(seen, differences);
    for (int k = 0; open && k < kCoordinates; ++k) finite = finite && is_finite(c[k]);
  }
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  if (threadIdx.x % 32 == 0) {
    hits[i / 32] = 0;
    declined[i / 32] = declined_word;
  }
  add_of_block(left, left, open && finite ? 0 : -1, i);
}

// Runs the filter in doubles, and the test for a shared vertex.
__global__ void __launch_bounds__(kThreads, 2)
    filter_doubles(const __grid_constant__ ArrayPairs pairs, PairList from, PairList left, std::uint32_t* hits) {
  decide_listed(pairs, from, left, hits, nullptr, [](const double* c, bool& yes) {
    const Finding found = exact::detail::filter(c, c + 9);
    yes = found == Finding::crosses || (found == Finding::unsure && exact::detail::shared_vertex(c, c + 9) >= 0);
    return found == Finding::unsure && !yes ? kLeft : static_cast<int>(Stage::bounded);
  });
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

// Each list reuses the memory of the list two places before it, which is no longer needed.
struct QueryLists {
  PairList left[kQueryLists];

  QueryLists(std::uint32_t* places, std::uint32_t* counts, std::uint32_t triangles, cudaStream_t stream) {
    check(cudaMemsetAsync(counts, 0, kQueryLists * sizeof *counts, stream));
    for (std::uint32_t k = 0; k < kQueryLists; ++k) left[k] = {places + (k % 2) * triangles, counts + k};
  }
};

}  // namespace

void launch_exact_query(const exact::PreparedTriangle& seen, const double* reference, const QueryChunk& chunk,
                        std::uint32_t* lists, std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined,
                        cudaStream_t stream) {
  const auto [left] = QueryLists(lists, counts, chunk.count, stream);
  ArrayPairs pairs{{}, chunk.array, {}, chunk.first};
  std::copy_n(reference, 9, pairs.reference);
  decide_doubles_by_slabs<<<thread_blocks(chunk), kThreads, 0, stream>>>(seen, pairs, chunk.count, left[0], hits,
                                                                         declined);
  filter_doubles<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[0], left[1], hits);
  static_assert(1 + kDoubleLists <= kQueryLists);
  launch_double_steps(pairs, left + 1, hits, nullptr, stream);
}

void launch_exact_query(const exact::PreparedTriangle& reference, const QueryChunk& chunk, std::uint32_t* lists,
                        std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined, cudaStream_t stream) {
  const auto [left] = QueryLists(lists, counts, chunk.count, stream);
  check(cudaMemsetAsync(declined, 0, row_words(chunk.count) * sizeof *declined, stream));
  const QueryPairs pairs{reference, chunk};
  launch_slabs(reference, chunk, left[0], hits, stream);
  decide_on_grid<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[0], left[1], hits, declined);
  filter_listed<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[1], left[2], hits);
  launch_large_steps(pairs, left + 2, hits, nullptr, stream);
}

void launch_pair_up(const exact::PreparedTriangle& reference, const QueryChunk& chunk, float* columns,
                    std::uint32_t* not_finite, cudaStream_t stream) {
  pair_up<<<thread_blocks(chunk), kThreads, 0, stream>>>({reference, chunk}, row_words(chunk.count) * 32, columns,
                                                         not_finite);
  check(cudaGetLastError());
}

}  // namespace graze::cuda
