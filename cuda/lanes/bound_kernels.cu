// SPDX-License-Identifier: Apache-2.0
// The device lanes with the policy `bound`. This file is compiled once for each device variant with valid error bounds,
// with its flags and in its own namespace GRAZE_FP. Define nothing else here, or the linker would mix the variants.
// These lanes need no twins, because each verdict is exact or declined. Their PTX is ten times as long as other lanes'.
#include "core/lanes/decide_under.h"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/vote.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {

template <int algorithm, class Real, class Pairs>
__global__ void bound_pairs(Pairs pairs, std::uint32_t* intersects, std::uint32_t* declined) {
  vote<Real>(pairs, intersects, declined, [](const auto& a, const auto& b) {
    return decide_bounded<std::tuple_element_t<algorithm, Algorithms>>(a, b);
  });
}

template <int algorithm, class Real, class Pairs>
void launch_bound(Pairs pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream) {
  bound_pairs<algorithm, Real><<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, intersects, declined);
}

// The launcher; null for algorithms that would be wrong even without rounding.
template <int algorithm, class Real, class Pairs>
constexpr auto launch() -> decltype(&launch_bound<algorithm, Real, Pairs>) {
  if constexpr (std::tuple_element_t<algorithm, Algorithms>::kInfo.right_without_rounding) {
    return launch_bound<algorithm, Real, Pairs>;
  } else {
    return nullptr;
  }
}

template <int... algorithm>
constexpr BoundKernels kernels(std::integer_sequence<int, algorithm...>) {
  return {{std::array<LaunchDecide, 2>{launch<algorithm, float, DevicePairs>(),
                                       launch<algorithm, double, DevicePairs>()}...},
          {launch<algorithm, double, DeviceDoubles>()...}};
}

extern const BoundKernels kBoundKernels = kernels(std::make_integer_sequence<int, kAlgorithmCount>());

}  // namespace GRAZE_FP
}  // namespace graze::cuda
