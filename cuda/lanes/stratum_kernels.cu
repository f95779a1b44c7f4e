// SPDX-License-Identifier: Apache-2.0
#include "cuda/lanes/stratum_kernels.cuh"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/generate.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace {

// Draws pair(first), …, pair(first + count - 1) on all CPU cores, as 18 arrays of `count` coordinates.
template <class Real, class Draw>
void draw_on_cores(const Draw& pair, std::uint64_t first, std::uint32_t count, std::vector<Real>& to) {
  to.resize(std::size_t{count} * kCoordinates);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& part) {
    for (std::uint32_t i = part.begin(); i != part.end(); ++i) {
      const BasicPair<Real> drawn = pair(first + i);
      for (std::size_t c = 0; c < kCoordinates; ++c) to[c * count + i] = coordinates(drawn)[c];
    }
  });
}

__global__ void store_in_float32(const double* from, std::size_t count, float* to) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) to[i] = static_cast<float>(from[i]);
}

}  // namespace
}  // namespace GRAZE_FP

void launch_generate(float* coordinates, std::uint32_t count, std::uint64_t seed, int stratum, std::uint64_t first,
                     cudaStream_t stream) {
  static constexpr auto kGenerators = generators<float>(std::make_index_sequence<strata::kStrataCount>());
  kGenerators[static_cast<std::size_t>(stratum)]<<<drawing_blocks(count), kDrawingThreads, 0, stream>>>(
      coordinates, count, seed, first);
}

void Drawing::draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, float* to,
                   cudaStream_t stream) {
  static constexpr auto kGenerators = generators_in<float>(std::make_index_sequence<strata::kStrataCount>());
  if (source.stratum >= 0 && source.scene) {
    kGenerators[static_cast<std::size_t>(source.stratum)]<<<drawing_blocks(count), kDrawingThreads, 0, stream>>>(
        *source.scene, to, count, source.seed, first);
  } else if (source.stratum >= 0) {
    launch_generate(to, count, source.seed, source.stratum, first, stream);
  } else {
    draw_on_cores(source.pair, first, count, brought_);
    // The source memory is not pinned, so cudaMemcpyAsync returns only after reading it.
    check(cudaMemcpyAsync(to, brought_.data(), brought_.size() * sizeof(float), cudaMemcpyHostToDevice, stream));
  }
  check(cudaGetLastError());
}

void Drawing::draw(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* to,
                   cudaStream_t stream, float* stored) {
  const std::size_t numbers = std::size_t{count} * kCoordinates;
  if (source.stratum >= 0) {
    launch_generate(source, first, count, to, stream);
  } else {
    draw_on_cores(source.double_pair, first, count, brought_doubles_);
    check(cudaMemcpyAsync(to, brought_doubles_.data(), numbers * sizeof *to, cudaMemcpyHostToDevice, stream));
  }
  if (stored)
    store_in_float32<<<drawing_blocks(static_cast<std::uint32_t>(numbers)), kDrawingThreads, 0, stream>>>(to, numbers,
                                                                                                          stored);
  check(cudaGetLastError());
}

}  // namespace graze::cuda
