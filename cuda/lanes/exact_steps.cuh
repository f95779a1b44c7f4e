// SPDX-License-Identifier: Apache-2.0
// The steps of the exact decision after the screen: the pairs that it left, where floats or doubles hold all
// determinants; then those that this left, on residues; then on 128-bit integers; then on wide integers. Hard pairs are
// listed, so that a warp does not wait for one of them in 32. Pairs: anything with a load(pairs, i, coordinates).
// Device code only.
#pragma once

#include "core/exact/exact.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/places.h"

namespace graze::cuda {
namespace {

using exact::Stage;
using exact::detail::Finding;
using exact::detail::Grid;
using exact::detail::NumberKinds;

__device__ bool is_finite(float x) { return (exact::detail::bits_of(x) & 0x7f800000u) != 0x7f800000u; }

__device__ void count(unsigned long long* stages, Stage stage, std::uint32_t pairs) {
  if (stages && pairs) atomicAdd(&stages[static_cast<int>(stage)], static_cast<unsigned long long>(pairs));
}

__device__ void set_bit(std::uint32_t* words, std::uint32_t i) { atomicOr(&words[i / 32], 1u << i % 32); }

// The decision in the smallest of the kinds that holds the grid.
template <class Kinds>
__device__ bool decide_in(const float* c, const Grid& grid) {
  return Kinds::visit(grid,
                      [&](auto numbers) { return exact::detail::decide<decltype(numbers)>(c, c + 9, grid.exponent); });
}

// By the smallest of the kinds that holds a pair's grid.
template <class Kinds, Stage stage, class Pairs>
__global__ void __launch_bounds__(kThreads, 2)
    decide_by(Pairs pairs, Places from, Places left, std::uint32_t* intersects, unsigned long long* stages) {
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Grid grid = exact::detail::grid_of(c, c + 9);
    if (!Kinds::hold(grid)) {
      left.add(i);
      continue;
    }
    if (decide_in<Kinds>(c, grid)) set_bit(intersects, i);
    count(stages, stage, 1);
  }
}

template <class Pairs>
__global__ void __launch_bounds__(kThreads, 2)
    decide_on_int128(Pairs pairs, Places from, Places left, std::uint32_t* intersects, unsigned long long* stages) {
  using Numbers = exact::detail::IntNumbers;
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Grid grid = exact::detail::grid_of(c, c + 9);
    bool yes;
    if (Numbers::holds(grid)) {
      yes = exact::detail::decide<Numbers>(c, c + 9, grid.exponent);
      count(stages, Stage::int128, 1);
    } else {
      const Finding found = by_planes(exact::detail::triangles<exact::detail::BoundedNumbers>(c, c + 9));
      yes = found == Finding::crosses || found == Finding::intersects;
      if (found == Finding::unsure) {
        left.add(i);
      } else {
        count(stages, Stage::bounded, 1);
      }
    }
    if (yes) set_bit(intersects, i);
  }
}

template <class Pairs>
__global__ void __launch_bounds__(kThreads)
    decide_on_wide(Pairs pairs, Places from, std::uint32_t* intersects, unsigned long long* stages) {
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Grid grid = exact::detail::grid_of(c, c + 9);
    if (decide_in<exact::detail::MultiwordNumbers>(c, grid)) set_bit(intersects, i);
    count(stages, Stage::wide, 1);
  }
}

constexpr int kBlocksForLeft = 1024;

// Of pairs that no small grid holds; the second list is for what one step leaves to the next, and empty.
template <class Pairs>
void launch_large_steps(const Pairs& pairs, Places first, Places second, std::uint32_t* intersects,
                        unsigned long long* stages, cudaStream_t stream) {
  decide_on_int128<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, first, second, intersects, stages);
  decide_on_wide<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, second, intersects, stages);
  check(cudaGetLastError());
}

// Decides the pairs of the first list; the other ones are for what the steps leave to each other, and empty.
template <class Pairs>
void launch_exact_steps(const Pairs& pairs, const Places (&left)[4], std::uint32_t* intersects,
                        unsigned long long* stages, cudaStream_t stream) {
  using namespace exact::detail;
  decide_by<NumberKinds<SingleNumbers, DoubleNumbers>, Stage::doubles>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[0], left[1], intersects, stages);
  decide_by<NumberKinds<ResidueNumbers>, Stage::int128>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[1], left[2], intersects, stages);
  launch_large_steps(pairs, left[2], left[3], intersects, stages, stream);
}

}  // namespace
}  // namespace graze::cuda
