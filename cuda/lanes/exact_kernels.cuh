// SPDX-License-Identifier: Apache-2.0
// The exact lane on the device. Device code only; cuda/lanes/device.h is the host's interface.
#pragma once

#include <cuda_runtime.h>

#include "core/algorithms/recording.h"

#include <cstdint>

#include "core/exact/exact.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/pair_list.h"
#include "cuda/lanes/triangles.h"

namespace graze {
struct Lane;
}

namespace graze::cuda {

// Pairs of doubles from arrays of triangles. Pair i has triangle first + i of a, or the reference if a is empty, and
// triangle first + i of b.
struct ArrayPairs {
  using Real = double;
  TriangleArray a, b;
  double reference[9];
  std::uint64_t first;
};

__device__ inline void load(const ArrayPairs& pairs, std::uint32_t i, double* c) {
  if (pairs.a.count > 0) {
    pairs.a.load(pairs.first + i, c);
  } else {
    for (int k = 0; k < 9; ++k) c[k] = pairs.reference[k];
  }
  pairs.b.load(pairs.first + i, c + 9);
}

// Decides the pairs of lists[0], which the filter left open. lists[1] to lists[3] must be empty: the steps fill them.
inline constexpr int kDoubleLists = 4;
void launch_double_steps(const ArrayPairs& pairs, const PairList* lists, std::uint32_t* intersects,
                         unsigned long long* stages, cudaStream_t stream);

// The filter fills two lists of pairs. The other lists are for pairs that one step leaves to the next.
inline constexpr int kExactLists = 6;

// The exact decision of blocks of pairs, with memory for the lists between its steps.
class DeviceExact {
 public:
  // Starts kernels that write bit i % 32 of word i / 32 of `intersects` and `declined` for pair i, up to the end of
  // a thread block. Unless `stages` is null, the kernels add to stages[s] the number of pairs that stage s decided.
  void decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, unsigned long long* stages,
              cudaStream_t stream);
  // Does the same for pairs of doubles.
  void decide(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined, unsigned long long* stages,
              cudaStream_t stream);
  // Decides only the pairs whose bit in `declined` is set, because a filter left them open. Pairs with a coordinate
  // that is not finite remain declined.
  void decide_declined(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream);
  void decide_declined(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream);

 private:
  void empty_lists(std::uint32_t pairs, cudaStream_t stream);

  DeviceArray<std::uint32_t> places_[kExactLists], counts_;
  PairList left_[kExactLists];
};

// Starts the kernels of a CUDA lane, which write the same words as DeviceExact::decide.
void launch_lane(const Lane& lane, DeviceExact& exact, DevicePairs pairs, std::uint32_t* intersects,
                 std::uint32_t* declined, cudaStream_t stream);
// Requires: a lane in double.
void launch_lane(const Lane& lane, DeviceExact& exact, DeviceDoubles pairs, std::uint32_t* intersects,
                 std::uint32_t* declined, cudaStream_t stream);

// Starts the kernel of a published CUDA lane that records its values; see core/lanes/records.h.
void launch_record(const Lane& lane, DevicePairs pairs, void* values, std::uint64_t stride, RecordedPath* paths);
// Requires: a lane in double.
void launch_record(const Lane& lane, DeviceDoubles pairs, void* values, std::uint64_t stride, RecordedPath* paths);

}  // namespace graze::cuda
