// SPDX-License-Identifier: Apache-2.0
// The device lanes with recording of every value that their comparisons see. This file is compiled once for each device
// variant, with its flags and in its own namespace GRAZE_FP. Define nothing else here, or the linker would mix the
// variants. The twins are generated from this file's PTX.
#include "core/algorithms/recording.h"
#include "core/lanes/lanes.h"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/vote.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {

template <int algorithm, class Real, class Pairs>
__device__ void record_one(const Pairs& pairs, const Recorded<Real>& to, RecordedPath* paths) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= pairs.count) return;
  const Triangles<Real> t = widened<Real>(pairs, i);
  paths[i] = record<std::tuple_element_t<algorithm, Algorithms>>(t.a, t.b, Recorded<Real>{to.values + i, to.stride});
}

// Each thread records one pair. The twin generator reads the algorithm's index (in Algorithms) from the kernel's name.
template <int algorithm, class Real>
__global__ void record_pairs(DevicePairs pairs, Recorded<Real> to, RecordedPath* paths) {
  record_one<algorithm>(pairs, to, paths);
}

// The kernel for pairs of doubles, which only lanes in double decide. Real is double.
template <int algorithm, class Real>
__global__ void record_double_pairs(DeviceDoubles pairs, Recorded<Real> to, RecordedPath* paths) {
  record_one<algorithm>(pairs, to, paths);
}

template <int algorithm, class Real>
void launch_record(DevicePairs pairs, void* values, std::uint64_t stride, RecordedPath* paths, cudaStream_t stream) {
  record_pairs<algorithm, Real>
      <<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, {static_cast<Real*>(values), stride}, paths);
}

template <int algorithm>
void launch_record_doubles(DeviceDoubles pairs, void* values, std::uint64_t stride, RecordedPath* paths,
                           cudaStream_t stream) {
  record_double_pairs<algorithm, double>
      <<<thread_blocks(pairs), kThreads, 0, stream>>>(pairs, {static_cast<double*>(values), stride}, paths);
}

template <int... algorithm>
constexpr RecordKernels launchers(std::integer_sequence<int, algorithm...>) {
  return {{std::array<LaunchValues, 2>{launch_record<algorithm, float>, launch_record<algorithm, double>}...},
          {launch_record_doubles<algorithm>...}};
}

extern const RecordKernels kRecordKernels = launchers(std::make_integer_sequence<int, kAlgorithmCount>());

}  // namespace GRAZE_FP
}  // namespace graze::cuda
