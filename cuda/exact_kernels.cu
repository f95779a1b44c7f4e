// SPDX-License-Identifier: Apache-2.0
// Three kernels: one thread a pair for the first attempt and for coordinates that doubles hold; then the pairs that it
// left, on 128-bit integers; then those that these left, on wide integers. Hard pairs are gathered, so that a warp does
// not wait for one of them in 32, and so that the first kernel, which sees all pairs, needs few registers.
#include "cuda/exact_kernels.h"

#include "cuda/kernels.h"

namespace graze {
namespace {

using exact::Stage;
using exact::detail::Answer;

__device__ bool is_finite(float x) { return (exact::detail::bits_of(x) & 0x7f800000u) != 0x7f800000u; }

__device__ void count(unsigned long long* stages, Stage stage, std::uint32_t pairs) {
  if (stages && pairs) atomicAdd(&stages[static_cast<int>(stage)], static_cast<unsigned long long>(pairs));
}

__device__ void leave(const LeftPairs& to, std::uint32_t at, const float* c, std::uint32_t place) {
  for (std::uint32_t k = 0; k < kCoordinates; ++k) to.coordinates[std::size_t{k} * to.stride + at] = c[k];
  to.places[at] = place;
}

__global__ void __launch_bounds__(kThreads, 2) decide_most(DevicePairs pairs, LeftPairs to, std::uint32_t* intersects,
                                                           std::uint32_t* declined, unsigned long long* stages) {
  // What the first attempt leaves: pairs that doubles hold from the front, the others from the back.
  __shared__ float left[kCoordinates][kThreads];
  __shared__ std::uint16_t place[kThreads];
  __shared__ std::uint32_t words[kThreads / 32], in_doubles, others, first_other;
  if (threadIdx.x == 0) in_doubles = others = 0;
  __syncthreads();

  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true, yes = false;
  if (i < pairs.count) {
    float c[kCoordinates];
    for (std::uint32_t k = 0; k < kCoordinates; ++k) {
      c[k] = pairs.coordinates[std::size_t{k} * pairs.stride + i];
      finite = finite && is_finite(c[k]);
    }
    const Answer answer = finite ? exact::detail::by_planes_quickly(c, c + 9) : Answer::disjoint;
    yes = answer == Answer::crosses;
    if (answer == Answer::unsure) {
      const bool doubles = exact::detail::grid_of(c, c + 9).bits <= 15;
      const std::uint32_t n = doubles ? atomicAdd(&in_doubles, 1u) : kThreads - 1 - atomicAdd(&others, 1u);
      place[n] = static_cast<std::uint16_t>(threadIdx.x);
      for (int k = 0; k < kCoordinates; ++k) left[k][n] = c[k];
    }
  }
  const std::uint32_t yes_word = __ballot_sync(0xffffffffu, yes);
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  if (threadIdx.x % 32 == 0) {
    words[threadIdx.x / 32] = yes_word;
    declined[i / 32] = declined_word;
  }
  __syncthreads();

  if (threadIdx.x == 0) {
    if (others) first_other = atomicAdd(to.count, others);
    const std::uint32_t here = min(pairs.count - blockIdx.x * kThreads, static_cast<std::uint32_t>(kThreads));
    count(stages, Stage::bounded, here - in_doubles - others);
    count(stages, Stage::doubles, in_doubles);
  }
  __syncthreads();
  if (threadIdx.x >= kThreads - others) {
    float c[kCoordinates];
    for (int k = 0; k < kCoordinates; ++k) c[k] = left[k][threadIdx.x];
    leave(to, first_other + kThreads - 1 - threadIdx.x, c, blockIdx.x * kThreads + place[threadIdx.x]);
  } else if (threadIdx.x < in_doubles) {
    float c[kCoordinates];
    for (int k = 0; k < kCoordinates; ++k) c[k] = left[k][threadIdx.x];
    const std::uint32_t at = place[threadIdx.x];
    if (exact::detail::decide<exact::detail::DoubleNumbers>(c, c + 9, 0)) atomicOr(&words[at / 32], 1u << at % 32);
  }
  __syncthreads();
  if (threadIdx.x < kThreads / 32) intersects[blockIdx.x * (kThreads / 32) + threadIdx.x] = words[threadIdx.x];
}

__device__ void fetch(const LeftPairs& from, std::uint32_t at, float* c) {
  for (std::uint32_t k = 0; k < kCoordinates; ++k) c[k] = from.coordinates[std::size_t{k} * from.stride + at];
}

__global__ void __launch_bounds__(kThreads)
    decide_on_int128(LeftPairs from, LeftPairs to, std::uint32_t* intersects, unsigned long long* stages) {
  for (std::uint32_t at = blockIdx.x * kThreads + threadIdx.x; at < *from.count; at += gridDim.x * kThreads) {
    float c[kCoordinates];
    fetch(from, at, c);
    const exact::detail::Grid grid = exact::detail::grid_of(c, c + 9);
    bool yes;
    if (grid.bits <= 40) {
      yes = grid.bits <= 30 ? exact::detail::decide<exact::detail::NarrowNumbers>(c, c + 9, grid.exponent)
                            : exact::detail::decide<exact::detail::IntNumbers>(c, c + 9, grid.exponent);
      count(stages, Stage::int128, 1);
    } else {
      const Answer answer = by_planes(exact::detail::triangles<exact::detail::BoundedNumbers>(c, c + 9));
      yes = answer == Answer::crosses || answer == Answer::intersects;
      if (answer == Answer::unsure) {
        leave(to, atomicAdd(to.count, 1u), c, from.places[at]);
      } else {
        count(stages, Stage::bounded, 1);
      }
    }
    if (yes) atomicOr(&intersects[from.places[at] / 32], 1u << from.places[at] % 32);
  }
}

__global__ void __launch_bounds__(kThreads)
    decide_on_wide(LeftPairs from, std::uint32_t* intersects, unsigned long long* stages) {
  for (std::uint32_t at = blockIdx.x * kThreads + threadIdx.x; at < *from.count; at += gridDim.x * kThreads) {
    float c[kCoordinates];
    fetch(from, at, c);
    if (exact::detail::decide<exact::detail::WideNumbers>(c, c + 9, 0))
      atomicOr(&intersects[from.places[at] / 32], 1u << from.places[at] % 32);
    count(stages, Stage::wide, 1);
  }
}

constexpr int kBlocksForLeft = 1024;

}  // namespace

LeftPairs DeviceExact::left(int stage, std::uint32_t most) {
  return {coordinates_[stage].at_least(std::size_t{most} * kCoordinates), most, places_[stage].at_least(most),
          counts_.at_least(2) + stage};
}

void DeviceExact::decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                         unsigned long long* stages, cudaStream_t stream) {
  if (pairs.count == 0) return;
  const LeftPairs for_int128 = left(0, pairs.count), for_wide = left(1, pairs.count);
  check(cudaMemsetAsync(for_int128.count, 0, 2 * sizeof(std::uint32_t), stream));
  decide_most<<<(pairs.count + kThreads - 1) / kThreads, kThreads, 0, stream>>>(pairs, for_int128, intersects, declined,
                                                                                stages);
  decide_on_int128<<<kBlocksForLeft, kThreads, 0, stream>>>(for_int128, for_wide, intersects, stages);
  decide_on_wide<<<kBlocksForLeft, kThreads, 0, stream>>>(for_wide, intersects, stages);
  check(cudaGetLastError());
}

}  // namespace graze
