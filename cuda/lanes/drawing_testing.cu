// SPDX-License-Identifier: Apache-2.0
#include "cuda/lanes/drawing_testing.h"

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/stratum_kernels.cuh"

namespace graze::cuda {
namespace {

template <class Real>
std::vector<BasicPair<Real>> fetched(const Real* from, std::uint32_t count) {
  std::vector<Real> columns(std::size_t{count} * kCoordinates);
  check(cudaMemcpy(columns.data(), from, columns.size() * sizeof(Real), cudaMemcpyDeviceToHost));
  std::vector<BasicPair<Real>> pairs(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < kCoordinates; ++c) coordinates(pairs[i])[c] = columns[c * count + i];
  }
  return pairs;
}

}  // namespace

strata::PairBlock drawn_for_device(const strata::PairSource& source, std::uint64_t first, std::uint32_t count) {
  const std::size_t numbers = std::size_t{count} * kCoordinates;
  Drawing drawing;
  DeviceArray<float> floats;
  DeviceArray<double> doubles;
  strata::PairBlock block;
  if (source.in_doubles()) {
    drawing.draw(source, first, count, doubles.at_least(numbers), nullptr, floats.at_least(numbers));
    block.doubles = fetched(doubles.at_least(0), count);
  } else {
    drawing.draw(source, first, count, floats.at_least(numbers), nullptr);
  }
  block.floats = fetched(floats.at_least(0), count);
  return block;
}

}  // namespace graze::cuda
