// SPDX-License-Identifier: Apache-2.0
// The kernels of a query, as their launchers see them. Device code only.
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

// The words of 32 bits that a row of verdicts takes: whole thread blocks of every kernel.
constexpr std::uint32_t row_words(std::uint32_t count) { return (count + 255) / 256 * 8; }

inline constexpr int kQueryLists = 6;

// What the slabs of the reference and the screen in floats show of a chunk: all words of `hits` are written, and what
// is left open is listed.
void launch_slabs(const exact::PreparedTriangle& reference, const QueryChunk& chunk, PairList left, std::uint32_t* hits,
                  cudaStream_t stream);

// The exact verdicts on a chunk: bit i % 32 of word i / 32. `lists`: room for 2 * count places; `counts`: kQueryLists.
void launch_exact_query(const exact::PreparedTriangle& reference, const QueryChunk& chunk, std::uint32_t* lists,
                        std::uint32_t* counts, std::uint32_t* hits, std::uint32_t* declined, cudaStream_t stream);

// The chunk as pairs with the reference, 18 columns of row_words(count) * 32; and which triangles are not finite.
void launch_pair_up(const exact::PreparedTriangle& reference, const QueryChunk& chunk, float* columns,
                    std::uint32_t* not_finite, cudaStream_t stream);

// Turns verdicts on what is not finite into declined ones.
void launch_decline(std::uint32_t words, const std::uint32_t* not_finite, std::uint32_t* hits, std::uint32_t* declined,
                    cudaStream_t stream);

// Adds to counts, which the caller has set up, what the first (count + 31) / 32 words say.
void launch_count(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, QueryCounts* counts,
                  cudaStream_t stream);

// Takes from the first row's declined ones those behind the first hit of all rows.
void launch_forget_behind(std::uint32_t count, const std::uint32_t* declined, QueryCounts* counts, std::uint32_t rows,
                          cudaStream_t stream);

// A byte for each triangle: 1 hit, 2 declined, else 0.
void launch_bytes(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, unsigned char* bytes,
                  cudaStream_t stream);

}  // namespace graze::cuda
