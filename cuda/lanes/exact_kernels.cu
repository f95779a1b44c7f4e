// SPDX-License-Identifier: Apache-2.0
// The filter, with one thread for each pair, which needs few registers. The steps of exact_steps.cuh then decide the
// pairs that the filter leaves open.
#include "cuda/lanes/exact_kernels.cuh"

#include "cuda/lanes/exact_steps.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {
namespace {

using exact::Stage;
using exact::detail::Finding;

__global__ void __launch_bounds__(kThreads, 3)
    decide_most(DevicePairs pairs, PairList in_floats, PairList left, std::uint32_t* intersects,
                std::uint32_t* declined, unsigned long long* stages) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  int list = -1;
  Finding found = Finding::disjoint;
  if (i < pairs.count) {
    float c[kCoordinates];
    load(pairs, i, c);
    for (float x : c) finite = finite && is_finite(x);
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
__global__ void __launch_bounds__(kThreads) list_declined(DevicePairs pairs, PairList in_floats, PairList left,
                                                          std::uint32_t* intersects, std::uint32_t* declined) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  bool finite = true;
  int list = -1;
  if (i < pairs.count && (declined[i / 32] >> i % 32 & 1)) {
    float c[kCoordinates];
    load(pairs, i, c);
    for (float x : c) finite = finite && is_finite(x);
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

}  // namespace

void DeviceExact::empty_lists(std::uint32_t pairs, cudaStream_t stream) {
  std::uint32_t* counts = counts_.at_least(std::size(left_));
  for (std::size_t k = 0; k < std::size(left_); ++k) left_[k] = {places_[k].at_least(pairs), counts + k};
  check(cudaMemsetAsync(counts, 0, std::size(left_) * sizeof *counts, stream));
}

void DeviceExact::decide_listed(DevicePairs pairs, std::uint32_t* intersects, unsigned long long* stages,
                                cudaStream_t stream) {
  launch_exact_steps(pairs, left_, intersects, stages, stream);
}

void DeviceExact::decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                         unsigned long long* stages, cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  decide_most<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, declined, stages);
  decide_listed(pairs, intersects, stages, stream);
}

void DeviceExact::decide_declined(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                                  cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  list_declined<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, declined);
  decide_listed(pairs, intersects, nullptr, stream);
}

}  // namespace graze::cuda
