// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/generate.cuh"
#include "cuda/lanes/stratum_kernels.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace {

constexpr int kOnlyInDoubles = strata::kDoubleStrataCount - strata::kStrataCount;

template <strata::Stratum stratum>
constexpr Generate<double> generator() {
  if constexpr (strata::is_drawn_on_devices(stratum)) {
    return generate_pairs<double, stratum>;
  } else {
    return nullptr;
  }
}

template <std::size_t... kPlace>
constexpr std::array<Generate<double>, sizeof...(kPlace)> other_generators(std::index_sequence<kPlace...>) {
  return {generator<strata::kDoubleStrata[strata::kStrataCount + kPlace].stratum>()...};
}

}  // namespace
}  // namespace GRAZE_FP

void launch_generate(const strata::PairSource& source, std::uint64_t first, std::uint32_t count, double* to,
                     cudaStream_t stream) {
  static constexpr auto kGenerators = generators<double>(std::make_index_sequence<strata::kStrataCount>());
  static constexpr auto kOthers = other_generators(std::make_index_sequence<kOnlyInDoubles>());
  static constexpr auto kInScene = generators_in<double>(std::make_index_sequence<strata::kStrataCount>());
  const auto stratum = static_cast<std::size_t>(source.stratum);
  if (source.scene) {
    kInScene.at(stratum)<<<drawing_blocks(count), kDrawingThreads, 0, stream>>>(*source.scene, to, count, source.seed,
                                                                                first);
  } else {
    const std::size_t other = stratum - static_cast<std::size_t>(strata::kDoubleStrata[strata::kStrataCount].stratum);
    const Generate<double> generate = stratum < kGenerators.size() ? kGenerators[stratum] : kOthers.at(other);
    generate<<<drawing_blocks(count), kDrawingThreads, 0, stream>>>(to, count, source.seed, first);
  }
  check(cudaGetLastError());
}

}  // namespace graze::cuda
