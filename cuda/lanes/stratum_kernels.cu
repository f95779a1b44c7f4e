// SPDX-License-Identifier: Apache-2.0
// Compiled with -fmad=false: without contraction the strata have the same bits as on the host.
#include "cuda/lanes/stratum_kernels.cuh"

#include <array>
#include <utility>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/draw_on_cores.h"
#include "strata/scene/scene.h"
#include "strata/strata.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace {

// A kernel for each stratum. A single kernel would need the registers and stack of the most expensive stratum.
template <strata::Stratum stratum>
__global__ void generate_pairs(float* coordinates, std::uint32_t count, std::uint64_t seed, std::uint64_t first) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const Pair pair = strata::generate(seed, stratum, first + i);
  const float* values = &pair.a[0].x;
  for (int c = 0; c < kCoordinates; ++c) coordinates[static_cast<std::size_t>(c) * count + i] = values[c];
}

template <strata::Stratum stratum>
__global__ void generate_pairs_in(const __grid_constant__ strata::Scene scene, float* coordinates, std::uint32_t count,
                                  std::uint64_t seed, std::uint64_t first) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const Pair pair = strata::generate(seed, stratum, scene, first + i);
  const float* values = &pair.a[0].x;
  for (int c = 0; c < kCoordinates; ++c) coordinates[static_cast<std::size_t>(c) * count + i] = values[c];
}

__device__ void note(Differences* differences, std::uint64_t place) {
  const unsigned long long n = atomicAdd(&differences->count, 1ull);
  if (n < kExamples) differences->places[n] = place;
}

__global__ void compare_bits(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t count, std::uint64_t first,
                             Differences* differences) {
  const std::uint32_t word = blockIdx.x * blockDim.x + threadIdx.x;
  if (word * 32 >= count) return;
  for (std::uint32_t differ = a[word] ^ b[word]; differ != 0; differ &= differ - 1) {
    const std::uint32_t place = word * 32 + static_cast<std::uint32_t>(__ffs(static_cast<int>(differ)) - 1);
    if (place < count) note(differences, first + place);
  }
}

__global__ void compare_hashes(const std::uint64_t* a, const std::uint64_t* b, std::uint32_t count, std::uint64_t first,
                               Differences* differences) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count && a[i] != b[i]) note(differences, first + i);
}

using Generate = void (*)(float*, std::uint32_t, std::uint64_t, std::uint64_t);

template <std::size_t... kStratum>
constexpr std::array<Generate, sizeof...(kStratum)> generators(std::index_sequence<kStratum...>) {
  return {generate_pairs<static_cast<strata::Stratum>(kStratum)>...};
}

using GenerateIn = void (*)(strata::Scene, float*, std::uint32_t, std::uint64_t, std::uint64_t);

template <std::size_t... kStratum>
constexpr std::array<GenerateIn, sizeof...(kStratum)> generators_in(std::index_sequence<kStratum...>) {
  return {generate_pairs_in<static_cast<strata::Stratum>(kStratum)>...};
}

__global__ void store_in_float32(const double* from, std::size_t count, float* to) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) to[i] = static_cast<float>(from[i]);
}

constexpr std::uint32_t kBlock = 256;
constexpr std::uint32_t blocks(std::uint32_t threads) { return (threads + kBlock - 1) / kBlock; }

}  // namespace
}  // namespace GRAZE_FP

void launch_generate(float* coordinates, std::uint32_t count, std::uint64_t seed, int stratum, std::uint64_t first,
                     cudaStream_t stream) {
  static constexpr auto kGenerators = generators(std::make_index_sequence<strata::kStrataCount>());
  kGenerators[static_cast<std::size_t>(stratum)]<<<blocks(count), kBlock, 0, stream>>>(coordinates, count, seed, first);
}

void Drawing::draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, float* to,
                   cudaStream_t stream) {
  static constexpr auto kGenerators = generators_in(std::make_index_sequence<strata::kStrataCount>());
  if (source.stratum >= 0 && source.scene) {
    kGenerators[static_cast<std::size_t>(source.stratum)]<<<blocks(count), kBlock, 0, stream>>>(
        *source.scene, to, count, source.seed, first);
  } else if (source.stratum >= 0) {
    launch_generate(to, count, source.seed, source.stratum, first, stream);
  } else {
    draw_on_cores(source.pair, first, count, brought_);
    // The memory is not pinned, so the copy has read it when this returns.
    check(cudaMemcpyAsync(to, brought_.data(), brought_.size() * sizeof(float), cudaMemcpyHostToDevice, stream));
  }
  check(cudaGetLastError());
}

void Drawing::draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* to,
                   float* stored, cudaStream_t stream) {
  draw_on_cores(source.double_pair, first, count, brought_doubles_);
  const std::size_t numbers = brought_doubles_.size();
  check(cudaMemcpyAsync(to, brought_doubles_.data(), numbers * sizeof *to, cudaMemcpyHostToDevice, stream));
  store_in_float32<<<blocks(static_cast<std::uint32_t>(numbers)), kBlock, 0, stream>>>(to, numbers, stored);
  check(cudaGetLastError());
}

void launch_compare_bits(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t count, std::uint64_t first,
                         Differences* differences, cudaStream_t stream) {
  compare_bits<<<blocks((count + 31) / 32), kBlock, 0, stream>>>(a, b, count, first, differences);
}

void launch_compare_hashes(const std::uint64_t* a, const std::uint64_t* b, std::uint32_t count, std::uint64_t first,
                           Differences* differences, cudaStream_t stream) {
  compare_hashes<<<blocks(count), kBlock, 0, stream>>>(a, b, count, first, differences);
}

}  // namespace graze::cuda
