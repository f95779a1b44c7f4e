// SPDX-License-Identifier: Apache-2.0
// Kernels that draw blocks of pairs from a stratum, with or without a scene, and kernels that count the differences
// between two runs. Device code only.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <vector>

#include "cuda/lanes/device_pairs.h"
#include "strata/pair_source.h"

namespace graze::cuda {

inline constexpr std::uint32_t kExamples = 8;

// The number of differences, and the indices of up to kExamples of them, in no particular order.
struct Differences {
  unsigned long long count;
  std::uint64_t places[kExamples];
};

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

// Counts the differences between the first `count` bits of a and b. Bit i % 32 of word i / 32 is for index first + i.
void launch_compare_bits(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t count, std::uint64_t first,
                         Differences* differences, cudaStream_t stream);
void launch_compare_hashes(const std::uint64_t* a, const std::uint64_t* b, std::uint32_t count, std::uint64_t first,
                           Differences* differences, cudaStream_t stream);

}  // namespace graze::cuda
