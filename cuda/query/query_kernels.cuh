// SPDX-License-Identifier: Apache-2.0
// Functions that launch the kernels of a query. Device code only.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "core/exact/prepared_triangle.h"
#include "core/pair.h"
#include "cuda/lanes/pair_list.h"
#include "cuda/query/device_query.h"

namespace graze::cuda {

// Triangles [first, first + count) of an array that the device can read.
struct QueryChunk {
  TriangleArray array;
  std::uint64_t first;
  std::uint32_t count;
};

// The number of 32-bit words in a row of verdicts, rounded up to whole thread blocks of every kernel.
constexpr std::uint32_t row_words(std::uint32_t count) { return (count + 255) / 256 * 8; }

inline constexpr int kQueryLists = 6;

// Decides the triangles of a chunk with the reference's slabs and the filter in floats. Writes all words of `hits`, and
// lists in `left` the triangles that remain open.
void launch_slabs(const exact::PreparedTriangle& reference, const QueryChunk& chunk, PairList left, std::uint32_t* hits,
                  cudaStream_t stream);

// Writes the exact verdicts on a chunk: bit i % 32 of word i / 32 for triangle i. `lists` has room for 2 * count
// indices, and `counts` for kQueryLists counters.
void launch_exact_query(const exact::PreparedTriangle& reference, const QueryChunk& chunk, std::uint32_t* lists,
                        std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined, cudaStream_t stream);

// Does the same for triangles of doubles. `seen` is the prepared reference, and `reference` its nine doubles.
void launch_exact_query(const exact::PreparedTriangle& seen, const double* reference, const QueryChunk& chunk,
                        std::uint32_t* lists, std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined,
                        cudaStream_t stream);

// Pairs the reference with each triangle of the chunk, and writes the pairs as 18 columns of row_words(count) * 32
// floats. Also marks the triangles with a coordinate that is not finite.
void launch_pair_up(const exact::PreparedTriangle& reference, const QueryChunk& chunk, float* columns,
                    std::uint32_t* not_finite, cudaStream_t stream);

}  // namespace graze::cuda
