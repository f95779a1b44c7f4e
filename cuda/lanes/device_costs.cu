// SPDX-License-Identifier: Apache-2.0
#include "cuda/lanes/device_costs.h"

#include <vector>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {
namespace {

constexpr int kLaunches = 4;  // launches timed together, because each launch costs a few microseconds

// The first kernel that `work` submits to the stream. Nothing is run.   Requires: `work` allocates nothing.
template <class Work>
const void* first_kernel(cudaStream_t stream, const Work& work) {
  cudaGraph_t graph;
  check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
  work();
  check(cudaStreamEndCapture(stream, &graph));
  std::size_t count = 0;
  check(cudaGraphGetNodes(graph, nullptr, &count));
  std::vector<cudaGraphNode_t> nodes(count);
  check(cudaGraphGetNodes(graph, nodes.data(), &count));
  const void* kernel = nullptr;
  for (const cudaGraphNode_t node : nodes) {
    cudaGraphNodeType type;
    check(cudaGraphNodeGetType(node, &type));
    if (kernel || type != cudaGraphNodeTypeKernel) continue;
    cudaKernelNodeParams parameters;
    check(cudaGraphKernelNodeGetParams(node, &parameters));
    kernel = parameters.func;
  }
  check(cudaGraphDestroy(graph));
  return kernel;
}

// Pairs in the kernels' layout, in device memory and in pinned memory, from which copies run at the link's speed.
template <class Real, class Pairs>
class Columns {
 public:
  explicit Columns(const std::vector<BasicPair<Real>>& pairs) : count_(pairs.size()) {
    Real* columns = columns_.at_least(count_ * kCoordinates);
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t c = 0; c < kCoordinates; ++c) columns[c * count_ + i] = coordinates(pairs[i])[c];
    }
    on_device_.at_least(count_ * kCoordinates);
  }
  Pairs pairs() {
    return {on_device_.at_least(0), static_cast<std::uint32_t>(count_), static_cast<std::uint32_t>(count_)};
  }
  void bring(cudaStream_t stream) {
    check(cudaMemcpyAsync(on_device_.at_least(0), columns_.at_least(0), count_ * sizeof(BasicPair<Real>),
                          cudaMemcpyHostToDevice, stream));
  }

 private:
  std::size_t count_;
  PinnedArray<Real> columns_;
  DeviceArray<Real> on_device_;
};

KernelNeeds needs_of(const void* kernel) {
  cudaFuncAttributes attributes;
  check(cudaFuncGetAttributes(&attributes, kernel));
  int blocks = 0;
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, kThreads, 0));
  return {kThreads, attributes.numRegs, static_cast<int>(attributes.localSizeBytes), blocks * kThreads};
}

}  // namespace

DeviceCosts measure_on_device(std::span<const Lane* const> lanes, const strata::PairBlock& pairs, int passes) {
  check(cudaSetDevice(0));
  cudaDeviceProp properties;
  check(cudaGetDeviceProperties(&properties, 0));
  DeviceCosts costs{properties.name, properties.maxThreadsPerMultiProcessor, std::vector<DeviceCost>(lanes.size())};
  const std::size_t count = pairs.size();
  const std::size_t words = (count + kThreads - 1) / kThreads * (kThreads / 32);
  PinnedArray<std::uint32_t> pinned;
  std::uint32_t* verdicts = pinned.at_least(2 * words);
  const Stream stream;
  Columns<float, DevicePairs> floats(pairs.floats);
  Columns<double, DeviceDoubles> doubles(pairs.doubles);
  DeviceArray<std::uint32_t> bits;
  DeviceExact exact;
  std::uint32_t* intersects = bits.at_least(2 * words);
  const auto in_doubles = [&](const Lane& lane) { return pairs.in_doubles() && lane.scalar == Scalar::f64; };
  const auto bring = [&](const Lane& lane) { in_doubles(lane) ? doubles.bring(stream) : floats.bring(stream); };
  const auto decide = [&](const Lane& lane) {
    const auto launch = [&](const auto& of) { launch_lane(lane, exact, of, intersects, intersects + words, stream); };
    in_doubles(lane) ? launch(doubles.pairs()) : launch(floats.pairs());
  };
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    bring(*lanes[l]);
    decide(*lanes[l]);  // allocates
    check(cudaStreamSynchronize(stream));
    costs.of[l].needs = needs_of(first_kernel(stream, [&] { decide(*lanes[l]); }));
  }
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      const double resident = timed(stream, [&] {
        for (int k = 0; k < kLaunches; ++k) decide(*lanes[l]);
      });
      const double with_copies = timed(stream, [&] {
        bring(*lanes[l]);
        decide(*lanes[l]);
        check(cudaMemcpyAsync(verdicts, intersects, 2 * words * sizeof *intersects, cudaMemcpyDeviceToHost, stream));
      });
      costs.of[l].resident.push_back(resident * 1e6 / kLaunches / static_cast<double>(count));
      costs.of[l].with_copies.push_back(with_copies * 1e6 / static_cast<double>(count));
    }
  }
  return costs;
}

}  // namespace graze::cuda
