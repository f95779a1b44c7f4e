// SPDX-License-Identifier: Apache-2.0
// Kernels that draw blocks of pairs from a stratum, with or without a scene, and that count differences between two
// runs. Device code only.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <vector>

#include "cuda/lanes/device_pairs.h"
#include "strata/pair_source.h"

namespace graze::cuda {

inline constexpr std::uint32_t kExamples = 8;

// The number of differences, and the indices of the first few found, in no particular order.
struct Differences {
  unsigned long long count;
  std::uint64_t places[kExamples];
};

// Writes pairs [first, first + count) of the stratum.
void launch_generate(float* coordinates, std::uint32_t count, std::uint64_t seed, int stratum, std::uint64_t first,
                     cudaStream_t stream);
// The same for a source of doubles, in its scene if it has one.   Requires: its stratum is known.
void launch_generate(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* coordinates,
                     cudaStream_t stream);

// Brings a source's pairs to a device. They are drawn on the device if it has the kernels. Otherwise all CPU cores draw
// them, and they are copied.
class Drawing {
 public:
  // Writes pairs [first, first + count) as 18 arrays of `count`, in the stream's order.
  void draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, float* coordinates,
            cudaStream_t stream);

  // The same for a source of doubles. `stored`, if not null, gets the pairs as float32 stores them.
  void draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* coordinates,
            cudaStream_t stream, float* stored = nullptr);

 private:
  std::vector<float> brought_;
  std::vector<double> brought_doubles_;
};

// Counts the set bits of (a ^ b), where bit i % 32 of word i / 32 is index i. Bits from `count` on are ignored.
void launch_compare_bits(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t count, std::uint64_t first,
                         Differences* differences, cudaStream_t stream);
void launch_compare_hashes(const std::uint64_t* a, const std::uint64_t* b, std::uint32_t count, std::uint64_t first,
                           Differences* differences, cudaStream_t stream);

}  // namespace graze::cuda
