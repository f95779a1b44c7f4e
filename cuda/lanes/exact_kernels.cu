// SPDX-License-Identifier: Apache-2.0
// Four kernels: the screen, one thread for each pair, which needs few registers; then the pairs that it left, where
// floats or doubles hold all determinants; then those that this left, on 128-bit integers; then those that these left,
// on wide integers. Hard pairs are listed, so that a warp does not wait for one of them in 32.
#include "cuda/lanes/exact_kernels.cuh"

#include "cuda/lanes/kernels.cuh"

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

__global__ void __launch_bounds__(kThreads, 3) decide_most(DevicePairs pairs, Places left, std::uint32_t* intersects,
                                                           std::uint32_t* declined, unsigned long long* stages) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  Finding found = Finding::disjoint;
  if (i < pairs.count) {
    float c[kCoordinates];
    load(pairs, i, c);
    for (float x : c) finite = finite && is_finite(x);
    if (finite) found = exact::detail::screen(c, c + 9);
    if (found == Finding::unsure && exact::detail::shared_vertex(c, c + 9) >= 0) found = Finding::intersects;
    if (found == Finding::unsure) left.add(i);
  }
  const std::uint32_t yes_word = __ballot_sync(0xffffffffu, found == Finding::crosses || found == Finding::intersects);
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  const std::uint32_t decided = __ballot_sync(0xffffffffu, i < pairs.count && found != Finding::unsure);
  if (threadIdx.x % 32 != 0) return;
  intersects[i / 32] = yes_word;
  declined[i / 32] = declined_word;
  count(stages, Stage::bounded, static_cast<std::uint32_t>(__popc(decided)));
}

// Lists the finite pairs that a filter declined, and takes their bits back.
__global__ void __launch_bounds__(kThreads)
    list_declined(DevicePairs pairs, Places left, std::uint32_t* intersects, std::uint32_t* declined) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  if (i < pairs.count && (declined[i / 32] >> i % 32 & 1)) {
    float c[kCoordinates];
    load(pairs, i, c);
    for (float x : c) finite = finite && is_finite(x);
    if (finite && exact::detail::shared_vertex(c, c + 9) >= 0) {
      set_bit(intersects, i);
    } else if (finite) {
      left.add(i);
    }
  }
  const std::uint32_t declined_word = __ballot_sync(0xffffffffu, !finite);
  if (threadIdx.x % 32 == 0) declined[i / 32] = declined_word;
}

__global__ void __launch_bounds__(kThreads, 2)
    decide_left(DevicePairs pairs, Places from, Places left, std::uint32_t* intersects, unsigned long long* stages) {
  using Numbers = NumberKinds<exact::detail::SingleNumbers, exact::detail::DoubleNumbers>;
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Grid grid = exact::detail::grid_of(c, c + 9);
    if (!Numbers::hold(grid)) {
      left.add(i);
      continue;
    }
    if (decide_in<Numbers>(c, grid)) set_bit(intersects, i);
    count(stages, Stage::doubles, 1);
  }
}

__global__ void __launch_bounds__(kThreads) decide_on_int128(DevicePairs pairs, Places from, Places left,
                                                             std::uint32_t* intersects, unsigned long long* stages) {
  using Numbers = NumberKinds<exact::detail::NarrowNumbers, exact::detail::IntNumbers>;
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *from.count; n += gridDim.x * kThreads) {
    const std::uint32_t i = from.at[n];
    float c[kCoordinates];
    load(pairs, i, c);
    const Grid grid = exact::detail::grid_of(c, c + 9);
    bool yes;
    if (Numbers::hold(grid)) {
      yes = decide_in<Numbers>(c, grid);
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

__global__ void __launch_bounds__(kThreads)
    decide_on_wide(DevicePairs pairs, Places from, std::uint32_t* intersects, unsigned long long* stages) {
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

}  // namespace

void DeviceExact::empty_lists(std::uint32_t pairs, cudaStream_t stream) {
  std::uint32_t* counts = counts_.at_least(std::size(left_));
  for (std::size_t k = 0; k < std::size(left_); ++k) left_[k] = {places_[k].at_least(pairs), counts + k};
  check(cudaMemsetAsync(counts, 0, std::size(left_) * sizeof *counts, stream));
}

void DeviceExact::decide_listed(DevicePairs pairs, std::uint32_t* intersects, unsigned long long* stages,
                                cudaStream_t stream) {
  decide_left<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, stages);
  decide_on_int128<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left_[1], left_[2], intersects, stages);
  decide_on_wide<<<kBlocksForLeft, kThreads, 0, stream>>>(pairs, left_[2], intersects, stages);
  check(cudaGetLastError());
}

void DeviceExact::decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                         unsigned long long* stages, cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  decide_most<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], intersects, declined, stages);
  decide_listed(pairs, intersects, stages, stream);
}

void DeviceExact::decide_declined(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                                  cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  list_declined<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], intersects, declined);
  decide_listed(pairs, intersects, nullptr, stream);
}

}  // namespace graze::cuda
