// SPDX-License-Identifier: Apache-2.0
// The filter and the later steps of the exact decision. The first steps take the pairs whose determinants fit in floats
// or in doubles. The next steps use residues, then 128-bit integers or tighter bounds, then wide integers. Each step
// lists the pairs that it cannot decide, so that a warp does not wait for one hard pair in 32. Pairs is any type that
// load(pairs, i, coordinates) accepts; its member Real is the coordinates' type. Device code only.
#pragma once

#include "core/exact/exact.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/double_double_numbers.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/pair_list.h"

namespace graze::cuda {
namespace {

using exact::Stage;
using exact::detail::Finding;
using exact::detail::Grid;
using exact::detail::NumberKinds;

__device__ bool is_finite(float x) { return (exact::detail::bits_of(x) & 0x7f800000u) != 0x7f800000u; }
__device__ bool is_finite(double x) { return (exact::detail::bits_of(x) & 0x7ff0000000000000u) != 0x7ff0000000000000u; }

__device__ void count(unsigned long long* stages, Stage stage, std::uint32_t pairs) {
  if (stages && pairs) atomicAdd(&stages[static_cast<int>(stage)], static_cast<unsigned long long>(pairs));
}

// Adds the counts of all threads of a warp. All threads of the warp must call this function.
__device__ void count_of_warp(unsigned long long* stages, Stage stage, std::uint32_t pairs) {
  for (int far = 16; far > 0; far /= 2) pairs += __shfl_xor_sync(0xffffffffu, pairs, far);
  if (threadIdx.x % 32 == 0) count(stages, stage, pairs);
}

__device__ void set_bit(std::uint32_t* words, std::uint32_t i) { atomicOr(&words[i / 32], 1u << i % 32); }

// Whether floats represent the pair's numbers exactly. Returns the same as SingleNumbers::holds on the pair's grid,
// with fewer instructions.
__device__ bool floats_hold(const float* c) {
  float most = 0;
  for (int i = 0; i < kCoordinates; ++i) most = fmaxf(most, fabsf(c[i]));
  // All coordinates times 2^-exponent are less than 2^kSingleBits.
  const int exponent = static_cast<int>(exact::detail::bits_of(most) >> 23) - 126 - exact::detail::kSingleBits;
  if (exponent < -30 || exponent > 30) return false;
  const float scale = __uint_as_float(static_cast<unsigned>(127 - exponent) << 23);
  bool whole = true;
  for (int i = 0; i < kCoordinates; ++i) {
    const float x = c[i] * scale;
    whole = whole && __fadd_rn(__fadd_rn(x, 0x1.8p23f), -0x1.8p23f) == x;  // rounded to an integer
  }
  return whole;
}

// The list for a pair that the filter leaves open: 0 if floats represent its numbers, else 1. Doubles are not tested.
__device__ int list_of(const float* c) { return floats_hold(c) ? 0 : 1; }
__device__ int list_of(const double*) { return 1; }

// Runs the filter and the test for a shared vertex, with one thread for each pair. Lists the pairs that remain open.
template <int kThreadBlocks, class Pairs>
__global__ void __launch_bounds__(kThreads, kThreadBlocks)
    decide_most(Pairs pairs, PairList in_floats, PairList left, std::uint32_t* intersects, std::uint32_t* declined,
                unsigned long long* stages) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  int list = -1;
  Finding found = Finding::disjoint;
  if (i < pairs.count) {
    typename Pairs::Real c[kCoordinates];
    load(pairs, i, c);
    for (const auto x : c) finite = finite && is_finite(x);
    if (finite) found = exact::detail::filter(c, c + 9);
    if (found == Finding::unsure && exact::detail::shared_vertex(c, c + 9) >= 0) found = Finding::intersects;
    if (found == Finding::unsure) list = list_of(c);
  }
  const std::uint32_t yes_word = __ballot_sync(0xffffffffu, found == Finding::crosses || found == Finding::intersects);
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  const std::uint32_t decided = __ballot_sync(0xffffffffu, i < pairs.count && found != Finding::unsure);
  if (threadIdx.x % 32 == 0) {
    intersects[i / 32] = yes_word;
    declined[i / 32] = declined_word;
    count(stages, Stage::bounded, static_cast<std::uint32_t>(__popc(decided)));
  }
  add_of_block(in_floats, left, list, i);
}

// Lists the finite pairs that a filter declined, and clears their bits in `declined`.
template <class Pairs>
__global__ void __launch_bounds__(kThreads)
    list_declined(Pairs pairs, PairList in_floats, PairList left, std::uint32_t* intersects, std::uint32_t* declined) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  int list = -1;
  if (i < pairs.count && (declined[i / 32] >> i % 32 & 1)) {
    typename Pairs::Real c[kCoordinates];
    load(pairs, i, c);
    for (const auto x : c) finite = finite && is_finite(x);
    if (finite && exact::detail::shared_vertex(c, c + 9) >= 0) {
      set_bit(intersects, i);
    } else if (finite) {
      list = list_of(c);
    }
  }
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  if (threadIdx.x % 32 == 0) declined[i / 32] = declined_word;
  add_of_block(in_floats, left, list, i);
}

// Calls decide(coordinates, yes) for each pair of a list. `decide` returns the stage that decided, and sets `yes` to
// whether the pair intersects. If `decide` returns kLeft, the pair goes to the list `left`.
constexpr int kLeft = exact::kStages;

template <class Pairs, class Decide>
__device__ void decide_listed(const Pairs& pairs, const PairList& from, const PairList& left, std::uint32_t* intersects,
                              unsigned long long* stages, const Decide& decide) {
  const std::uint32_t count = *from.count;
  std::uint32_t decided[exact::kStages] = {};
  for (std::uint32_t first = blockIdx.x * kThreads; first < count; first += gridDim.x * kThreads) {
    const std::uint32_t n = first + threadIdx.x;
    const std::uint32_t i = n < count ? from.at[n] : 0;
    bool is_left = false;
    if (n < count) {
      typename Pairs::Real c[kCoordinates];
      load(pairs, i, c);
      bool yes = false;
      const int stage = decide(c, yes);
      is_left = stage == kLeft;
      for (int s = 0; s < exact::kStages; ++s) decided[s] += stage == s;
      if (yes) set_bit(intersects, i);
    }
    add_of_block(left, left, is_left ? 0 : -1, i);
  }
  for (int s = 0; s < exact::kStages; ++s) count_of_warp(stages, static_cast<Stage>(s), decided[s]);
}

// Decides pairs whose numbers floats represent exactly.
template <class Pairs>
__global__ void __launch_bounds__(kThreads, 3)
    decide_by_floats(Pairs pairs, PairList from, std::uint32_t* intersects, unsigned long long* stages) {
  decide_listed(pairs, from, PairList{}, intersects, stages, [](const float* c, bool& yes) {
    yes = exact::detail::decide<exact::detail::SingleNumbers>(c, c + 9, 0);
    return static_cast<int>(Stage::doubles);
  });
}

// Decides with the smallest number type of Kinds that holds a pair's grid. kThreadBlocks: how many thread blocks a
// multiprocessor should run at once; this limits the registers.
template <class Kinds, int kThreadBlocks, class Pairs>
__global__ void __launch_bounds__(kThreads, kThreadBlocks)
    decide_by(Pairs pairs, PairList from, PairList left, std::uint32_t* intersects, unsigned long long* stages) {
  decide_listed(pairs, from, left, intersects, stages, [](const auto* c, bool& yes) {
    const Grid grid = exact::detail::grid_of(c, c + 9);
    if (!Kinds::hold(grid)) return kLeft;
    return Kinds::visit(grid, [&](auto numbers) {
      yes = exact::detail::decide<decltype(numbers)>(c, c + 9, grid.exponent);
      return static_cast<int>(numbers.kStage);
    });
  });
}

// Decides in 128-bit integers if they represent the pair's numbers, otherwise with an error bound for each determinant.
template <class Pairs>
__global__ void __launch_bounds__(kThreads, 2)
    decide_on_int128(Pairs pairs, PairList from, PairList left, std::uint32_t* intersects, unsigned long long* stages) {
  using Numbers = exact::detail::IntNumbers;
  decide_listed(pairs, from, left, intersects, stages, [](const float* c, bool& yes) {
    const Grid grid = exact::detail::grid_of(c, c + 9);
    if (Numbers::holds(grid)) {
      yes = exact::detail::decide<Numbers>(c, c + 9, grid.exponent);
      return static_cast<int>(Stage::int128);
    }
    const Finding found = by_planes(exact::detail::triangles<exact::detail::BoundedNumbers>(c, c + 9));
    yes = found == Finding::crosses || found == Finding::intersects;
    return found == Finding::unsure ? kLeft : static_cast<int>(Stage::bounded);
  });
}

// Whether double-double numbers represent a pair's determinants without overflow or underflow.
__device__ bool is_moderate(const float*) { return true; }
__device__ bool is_moderate(const double* c) { return exact::detail::is_moderate(exact::detail::grid_of(c, c + 9)); }

// Decides with tighter error bounds, in double-double precision.
template <class Pairs>
__global__ void __launch_bounds__(kThreads, 2)
    decide_closely(Pairs pairs, PairList from, PairList left, std::uint32_t* intersects, unsigned long long* stages) {
  decide_listed(pairs, from, left, intersects, stages, [](const auto* c, bool& yes) {
    if (!is_moderate(c)) return kLeft;
    const Finding found = by_planes(exact::detail::triangles<DoubleDoubleNumbers>(c, c + 9));
    yes = found == Finding::crosses || found == Finding::intersects;
    return found == Finding::unsure ? kLeft : static_cast<int>(Stage::bounded);
  });
}

// Decides with double-double bounds. If these leave a determinant's sign open, computes the sign in wide integers.
template <class Pairs>
__global__ void __launch_bounds__(kThreads) decide_one_by_one(Pairs pairs, PairList from, PairList left,
                                                              std::uint32_t* intersects, unsigned long long* stages) {
  using exact::detail::WideNumbers;
  decide_listed(pairs, from, left, intersects, stages, [](const float* c, bool& yes) {
    Stage stage = Stage::bounded;
    const Finding found = exact::detail::by_planes_one_by_one<DoubleDoubleNumbers, WideNumbers>(c, c + 9, 0, stage);
    yes = found == Finding::intersects;
    return found == Finding::unsure ? kLeft : static_cast<int>(stage);
  });
}

constexpr int kBlocksForLeft = 1024;

// Decides pairs whose grid is too large for the small number types. left[0] lists the pairs to decide. left[1] to
// left[3] must be empty: each is for the pairs that one step leaves to the next.
template <class Pairs>
void launch_large_steps(const Pairs& pairs, const PairList* left, std::uint32_t* intersects, unsigned long long* stages,
                        cudaStream_t stream) {
  decide_on_int128<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[0], left[1], intersects, stages);
  decide_closely<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[1], left[2], intersects, stages);
  decide_one_by_one<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[2], left[3], intersects, stages);
  decide_by<exact::detail::MultiwordNumbers, 1>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[3], PairList{}, intersects, stages);
  check(cudaGetLastError());
}

// Decides the pairs of the first two lists; floats represent the numbers of the pairs in left[0]. The other lists must
// be empty: the steps fill them.
template <class Pairs>
void launch_exact_steps(const Pairs& pairs, const PairList (&left)[kExactLists], std::uint32_t* intersects,
                        unsigned long long* stages, cudaStream_t stream) {
  using namespace exact::detail;
  decide_by_floats<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[0], intersects, stages);
  decide_by<NumberKinds<DoubleNumbers, ResidueNumbers>, 2>
      <<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left[1], left[2], intersects, stages);
  launch_large_steps(pairs, left + 2, intersects, stages, stream);
}

}  // namespace
}  // namespace graze::cuda
