// SPDX-License-Identifier: Apache-2.0
// The device lanes. Compiled twice, each time in its own namespace GRAZE_FP: with -fmad=false, and with nvcc's
// default contraction. Nothing else may be defined here, or the linker would mix the variants.
#include "cuda/kernels.h"

namespace graze {
inline namespace GRAZE_FP {

// One thread a pair. The algorithm is its place in Algorithms, so that the twin generator knows the kernel by its name.
template <int algorithm, class Real>
__global__ void decide_pairs(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  Verdict verdict = Verdict::disjoint;
  if (i < pairs.count) {
    const float* c = pairs.coordinates + i;
    const auto vertex = [&](int v) {
      return Vec3<Real>{Real(c[(3 * v) * pairs.stride]), Real(c[(3 * v + 1) * pairs.stride]), Real(c[(3 * v + 2) * pairs.stride])};
    };
    const Vec3<Real> a[3] = {vertex(0), vertex(1), vertex(2)};
    const Vec3<Real> b[3] = {vertex(3), vertex(4), vertex(5)};
    verdict = std::tuple_element_t<algorithm, Algorithms>::decide(a, b);
  }
  const std::uint32_t yes = __ballot_sync(0xffffffffu, verdict == Verdict::intersects);
  const std::uint32_t no_answer = __ballot_sync(0xffffffffu, verdict == Verdict::declined);
  if (threadIdx.x % 32 == 0) {
    intersects[i / 32] = yes;
    declined[i / 32] = no_answer;
  }
}

template <int algorithm, class Real>
void launch_decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream) {
  decide_pairs<algorithm, Real><<<(pairs.count + kThreads - 1) / kThreads, kThreads, 0, stream>>>(pairs, intersects, declined);
}

template <int... algorithm>
constexpr DeviceKernels launchers(std::integer_sequence<int, algorithm...>) {
  return {std::array<LaunchDecide, 2>{launch_decide<algorithm, float>, launch_decide<algorithm, double>}...};
}

}  // namespace GRAZE_FP

extern const DeviceKernels GRAZE_DEVICE_KERNELS = launchers(std::make_integer_sequence<int, kAlgorithmCount>());

}  // namespace graze
