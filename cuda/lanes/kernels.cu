// SPDX-License-Identifier: Apache-2.0
// The device lanes, and the same algorithms with a trace of their intermediate values. This file is compiled once for
// each device variant, with its flags and in its own namespace GRAZE_FP. Define nothing else here, or the linker would
// mix the variants. The twins are generated from this file's PTX: see cuda/twin/twin.h.
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/trace.h"
#include "cuda/lanes/vote.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {

// Each thread decides one pair. The twin generator reads the algorithm's index (in Algorithms) from the kernel's name.
template <int algorithm, class Real>
__global__ void decide_pairs(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined,
             [](const auto& a, const auto& b) { return std::tuple_element_t<algorithm, Algorithms>::decide(a, b); });
}

template <int algorithm, class Real, class Pairs>
__device__ void trace(const Pairs& pairs, std::uint64_t* hashes) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= pairs.count) return;
  const Triangles<Real> t = widened<Real>(pairs, i);
  std::uint64_t hash = 0;
  const Verdict verdict = std::tuple_element_t<algorithm, Algorithms>::decide(t.a, t.b, TracePolicy{&hash});
  hashes[i] = hash ^ static_cast<std::uint64_t>(verdict);
}

template <int algorithm, class Real>
__global__ void trace_pairs(DevicePairs pairs, std::uint64_t* hashes) {
  trace<algorithm, Real>(pairs, hashes);
}

// The kernels for pairs of doubles, which only lanes in double decide. Real is double.
template <int algorithm, class Real>
__global__ void decide_double_pairs(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined,
             [](const auto& a, const auto& b) { return std::tuple_element_t<algorithm, Algorithms>::decide(a, b); });
}

template <int algorithm, class Real>
__global__ void trace_double_pairs(DeviceDoubles pairs, std::uint64_t* hashes) {
  trace<algorithm, Real>(pairs, hashes);
}

template <int algorithm, class Real>
void launch_decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream) {
  decide_pairs<algorithm, Real><<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, intersects, declined);
}

template <int algorithm, class Real>
void launch_trace(DevicePairs pairs, std::uint64_t* hashes, cudaStream_t stream) {
  trace_pairs<algorithm, Real><<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, hashes);
}

template <int algorithm>
void launch_decide_doubles(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined,
                           cudaStream_t stream) {
  decide_double_pairs<algorithm, double><<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, intersects, declined);
}

template <int algorithm>
void launch_trace_doubles(DeviceDoubles pairs, std::uint64_t* hashes, cudaStream_t stream) {
  trace_double_pairs<algorithm, double><<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, hashes);
}

template <int... algorithm>
constexpr DeviceKernels<LaunchDecide> decide_launchers(std::integer_sequence<int, algorithm...>) {
  return {std::array<LaunchDecide, 2>{launch_decide<algorithm, float>, launch_decide<algorithm, double>}...};
}

template <int... algorithm>
constexpr DeviceKernels<LaunchTrace> trace_launchers(std::integer_sequence<int, algorithm...>) {
  return {std::array<LaunchTrace, 2>{launch_trace<algorithm, float>, launch_trace<algorithm, double>}...};
}

template <int... algorithm>
constexpr VariantKernels kernels(std::integer_sequence<int, algorithm...> all) {
  return {decide_launchers(all),
          trace_launchers(all),
          {launch_decide_doubles<algorithm>...},
          {launch_trace_doubles<algorithm>...}};
}

extern const VariantKernels kKernels = kernels(std::make_integer_sequence<int, kAlgorithmCount>());

}  // namespace GRAZE_FP

}  // namespace graze::cuda
