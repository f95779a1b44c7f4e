// SPDX-License-Identifier: Apache-2.0
// The kernels of a query, as seen by the code that launches them. Device code only.
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

// The number of 32-bit words in a row of verdicts: a whole number of thread blocks of every kernel.
constexpr std::uint32_t row_words(std::uint32_t count) { return (count + 255) / 256 * 8; }

inline constexpr int kQueryLists = 6;

// Decides triangles of a chunk with the reference's slabs and the filter in floats. It writes all words of `hits`, and
// lists in `left` the triangles that remain open.
void launch_slabs(const exact::PreparedTriangle& reference, const QueryChunk& chunk, PairList left, std::uint32_t* hits,
                  cudaStream_t stream);

// Writes the exact verdicts on a chunk as bits i % 32 of words i / 32. `lists` has room for 2 * count indices, `counts`
// has kQueryLists counters.
void launch_exact_query(const exact::PreparedTriangle& reference, const QueryChunk& chunk, std::uint32_t* lists,
                        std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined, cudaStream_t stream);

// The same for triangles of doubles. `seen` is the reference as prepared from its doubles.
void launch_exact_query(const exact::PreparedTriangle& seen, const double* reference, const QueryChunk& chunk,
                        std::uint32_t* lists, std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined,
                        cudaStream_t stream);

// Writes each triangle of the chunk as a pair with the reference: 18 columns of row_words(count) * 32 floats. Also
// marks the triangles that are not finite.
void launch_pair_up(const exact::PreparedTriangle& reference, const QueryChunk& chunk, float* columns,
                    std::uint32_t* not_finite, cudaStream_t stream);

// Sets the verdicts on triangles with coordinates that are not finite to declined.
void launch_decline(std::uint32_t words, const std::uint32_t* not_finite, std::uint32_t* hits, std::uint32_t* declined,
                    cudaStream_t stream);

// Adds the counts of the first (count + 31) / 32 words to `counts`, which the caller initialises.
void launch_count(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, QueryCounts* counts,
                  cudaStream_t stream);

// Subtracts from the first row's declined count the triangles after the first hit of all rows.
void launch_forget_behind(std::uint32_t count, const std::uint32_t* declined, QueryCounts* counts, std::uint32_t rows,
                          cudaStream_t stream);

// A byte for each triangle: 1 hit, 2 declined, else 0.
void launch_bytes(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, unsigned char* bytes,
                  cudaStream_t stream);

}  // namespace graze::cuda
