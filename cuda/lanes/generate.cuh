// SPDX-License-Identifier: Apache-2.0
// Kernels that draw pairs, one kernel for each stratum and coordinate type. A single kernel would need the registers
// and the stack of the most expensive stratum. The kernels are compiled with -fmad=false: with contraction, the pairs
// would not have the same bits as on the host.
#pragma once

#include <cuda_runtime.h>

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "strata/scene/scene.h"
#include "strata/strata.h"

namespace graze::cuda {
inline namespace GRAZE_FP {

// Thread i draws pair draw(first + i). The pairs are written as 18 arrays of `count` coordinates.
template <class Real, class Draw>
__device__ void generate_with(Real* coordinates, std::uint32_t count, std::uint64_t first, const Draw& draw) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const BasicPair<Real> pair = draw(first + i);
  const Real* values = &pair.a[0].x;
  for (int c = 0; c < kCoordinates; ++c) coordinates[static_cast<std::size_t>(c) * count + i] = values[c];
}

template <class Real>
using DrawsOf = std::conditional_t<std::is_same_v<Real, float>, strata::Draws, strata::DoubleDraws>;

template <class Real, strata::Stratum stratum>
__global__ void generate_pairs(Real* coordinates, std::uint32_t count, std::uint64_t seed, std::uint64_t first) {
  generate_with(coordinates, count, first,
                [seed](std::uint64_t index) { return strata::generate_one<stratum, DrawsOf<Real>>(seed, index); });
}

template <class Real, strata::Stratum stratum>
__global__ void generate_pairs_in(const __grid_constant__ strata::Scene scene, Real* coordinates, std::uint32_t count,
                                  std::uint64_t seed, std::uint64_t first) {
  generate_with(coordinates, count, first,
                [&](std::uint64_t index) { return strata::generate_one<stratum, DrawsOf<Real>>(seed, scene, index); });
}

// A kernel that draws pairs of a stratum. Arrays of these kernels are indexed by the stratum's number in kStrata.
template <class Real>
using Generate = void (*)(Real*, std::uint32_t, std::uint64_t, std::uint64_t);
template <class Real, std::size_t... kStratum>
constexpr std::array<Generate<Real>, sizeof...(kStratum)> generators(std::index_sequence<kStratum...>) {
  return {generate_pairs<Real, static_cast<strata::Stratum>(kStratum)>...};
}

template <class Real>
using GenerateIn = void (*)(strata::Scene, Real*, std::uint32_t, std::uint64_t, std::uint64_t);
template <class Real, std::size_t... kStratum>
constexpr std::array<GenerateIn<Real>, sizeof...(kStratum)> generators_in(std::index_sequence<kStratum...>) {
  return {generate_pairs_in<Real, static_cast<strata::Stratum>(kStratum)>...};
}

inline constexpr std::uint32_t kDrawingThreads = 256;
constexpr std::uint32_t drawing_blocks(std::uint32_t threads) {
  return (threads + kDrawingThreads - 1) / kDrawingThreads;
}

}  // namespace GRAZE_FP
}  // namespace graze::cuda
