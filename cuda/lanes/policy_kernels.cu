// SPDX-License-Identifier: Apache-2.0
// The device lanes with tolerances: policies abs, rel and paper. This file is compiled once for each device variant,
// with its flags and in its own namespace GRAZE_FP. Define nothing else here, or the linker would mix the variants. The
// twins are generated from this file's PTX.
#include "core/lanes/decide_under.h"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/vote.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {

// Each thread decides one pair. The twin generator reads the algorithm's index (in Algorithms) from the kernel's name.
template <int algorithm, class Real>
__global__ void absolute_pairs(DevicePairs pairs, Tolerances<Real> tolerances, std::uint32_t* intersects,
                               std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined, [&](const auto& a, const auto& b) {
    return decide_within<std::tuple_element_t<algorithm, Algorithms>, Real>(a, b, tolerances);
  });
}

template <int algorithm, class Real>
__global__ void relative_pairs(DevicePairs pairs, Tolerances<Real> tolerances, std::uint32_t* intersects,
                               std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined, [&](const auto& a, const auto& b) {
    return decide_within<std::tuple_element_t<algorithm, Algorithms>, WithMagnitude<Real>>(a, b, tolerances);
  });
}

// The kernels for pairs of doubles. Real is double.
template <int algorithm, class Real>
__global__ void absolute_double_pairs(DeviceDoubles pairs, Tolerances<Real> tolerances, std::uint32_t* intersects,
                                      std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined, [&](const auto& a, const auto& b) {
    return decide_within<std::tuple_element_t<algorithm, Algorithms>, Real>(a, b, tolerances);
  });
}

template <int algorithm, class Real>
__global__ void relative_double_pairs(DeviceDoubles pairs, Tolerances<Real> tolerances, std::uint32_t* intersects,
                                      std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined, [&](const auto& a, const auto& b) {
    return decide_within<std::tuple_element_t<algorithm, Algorithms>, WithMagnitude<Real>>(a, b, tolerances);
  });
}

template <int algorithm, class Real>
void launch_within(const Epsilons& epsilons, DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                   cudaStream_t stream) {
  const auto kernel = epsilons.any_relative() ? relative_pairs<algorithm, Real> : absolute_pairs<algorithm, Real>;
  kernel<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, Tolerances<Real>(epsilons), intersects, declined);
}

template <int algorithm>
void launch_within_doubles(const Epsilons& epsilons, DeviceDoubles pairs, std::uint32_t* intersects,
                           std::uint32_t* declined, cudaStream_t stream) {
  const auto kernel =
      epsilons.any_relative() ? relative_double_pairs<algorithm, double> : absolute_double_pairs<algorithm, double>;
  kernel<<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, Tolerances<double>(epsilons), intersects, declined);
}

template <int... algorithm>
constexpr WithinKernels kernels(std::integer_sequence<int, algorithm...>) {
  return {{std::array<LaunchWithin, 2>{launch_within<algorithm, float>, launch_within<algorithm, double>}...},
          {launch_within_doubles<algorithm>...}};
}

extern const WithinKernels kPolicyKernels = kernels(std::make_integer_sequence<int, kAlgorithmCount>());

}  // namespace GRAZE_FP
}  // namespace graze::cuda
