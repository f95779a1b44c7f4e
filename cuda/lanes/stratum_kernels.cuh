// SPDX-License-Identifier: Apache-2.0
// Kernels that draw blocks of pairs from a stratum, with or without a scene. Device code only.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <vector>

#include "cuda/lanes/device_pairs.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// Draws pairs [first, first + count) of the stratum.
void launch_generate(float* coordinates, std::uint32_t count, std::uint64_t seed, int stratum, std::uint64_t first,
                     cudaStream_t stream);
// Draws pairs from a source of doubles, in its scene if it has one.   Requires: source.stratum is not -1.
void launch_generate(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* coordinates,
                     cudaStream_t stream);

// Writes a source's pairs to device memory. The device draws the pairs if it has a kernel for the source; otherwise
// all CPU cores draw them, and the pairs are copied.
class Drawing {
 public:
  // Writes pairs [first, first + count) as 18 arrays of `count` coordinates, in the stream's order.
  void draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, float* coordinates,
            cudaStream_t stream);

  // The same for a source of doubles. `stored`, if not null, receives the pairs rounded to float32.
  void draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* coordinates,
            cudaStream_t stream, float* stored = nullptr);

 private:
  std::vector<float> brought_;
  std::vector<double> brought_doubles_;
};

}  // namespace graze::cuda
