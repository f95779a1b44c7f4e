// SPDX-License-Identifier: Apache-2.0
// The exact decision of float32 pairs. The filter runs first, with one thread per pair; it needs few registers. The
// steps of exact_steps.cuh then decide the pairs that the filter leaves open.
#include "cuda/lanes/exact_kernels.cuh"

#include "cuda/lanes/exact_steps.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {

void DeviceExact::empty_lists(std::uint32_t pairs, cudaStream_t stream) {
  std::uint32_t* counts = counts_.at_least(std::size(left_));
  for (std::size_t k = 0; k < std::size(left_); ++k) left_[k] = {places_[k].at_least(pairs), counts + k};
  check(cudaMemsetAsync(counts, 0, std::size(left_) * sizeof *counts, stream));
}

void DeviceExact::decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                         unsigned long long* stages, cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  decide_most<3>
      <<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, declined, stages);
  launch_exact_steps(pairs, left_, intersects, stages, stream);
}

void DeviceExact::decide_declined(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                                  cudaStream_t stream) {
  if (pairs.count == 0) return;
  empty_lists(pairs.count, stream);
  list_declined<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, left_[0], left_[1], intersects, declined);
  launch_exact_steps(pairs, left_, intersects, nullptr, stream);
}

}  // namespace graze::cuda
