// SPDX-License-Identifier: Apache-2.0
#include "cuda/lanes/device_costs.h"

#include <algorithm>
#include <functional>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {
namespace {

constexpr int kLaunches = 4;  // timed together, to make the few microseconds of a launch negligible

class Stream {
 public:
  Stream() {
    check(cudaStreamCreate(&stream_));
    check(cudaEventCreate(&start_));
    check(cudaEventCreate(&stop_));
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    cudaEventDestroy(start_);
    cudaEventDestroy(stop_);
    cudaStreamDestroy(stream_);
  }
  operator cudaStream_t() const { return stream_; }

  // Nanoseconds that the work submitted by `work` takes on the stream.
  double time(const std::function<void()>& work) const {
    check(cudaEventRecord(start_, stream_));
    work();
    check(cudaEventRecord(stop_, stream_));
    check(cudaEventSynchronize(stop_));
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, start_, stop_));
    return double{milliseconds} * 1e6;
  }

  // The first kernel that `work` submits to the stream. It does not run.   Requires: `work` allocates nothing.
  const void* first_kernel(const std::function<void()>& work) const {
    cudaGraph_t graph;
    check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal));
    work();
    check(cudaStreamEndCapture(stream_, &graph));
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

 private:
  cudaStream_t stream_;
  cudaEvent_t start_, stop_;
};

// Pinned memory, so that copies run at the speed of the link.
class Pinned {
 public:
  explicit Pinned(std::size_t bytes) { check(cudaMallocHost(&data_, bytes)); }
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;
  ~Pinned() { cudaFreeHost(data_); }
  template <class T>
  T* as() const {
    return static_cast<T*>(data_);
  }

 private:
  void* data_ = nullptr;
};

// Pairs in pinned memory and on the device, in the layout of the kernels.
template <class Real, class Pairs>
class Columns {
 public:
  explicit Columns(const std::vector<BasicPair<Real>>& pairs)
      : count_(pairs.size()), bytes_(count_ * sizeof(BasicPair<Real>)), columns_(bytes_ + 1) {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t c = 0; c < kCoordinates; ++c)
        columns_.template as<Real>()[c * count_ + i] = coordinates(pairs[i])[c];
    }
    on_device_.at_least(count_ * kCoordinates);
  }
  Pairs pairs() {
    return {on_device_.at_least(0), static_cast<std::uint32_t>(count_), static_cast<std::uint32_t>(count_)};
  }
  void bring(cudaStream_t stream) {
    check(
        cudaMemcpyAsync(on_device_.at_least(0), columns_.template as<Real>(), bytes_, cudaMemcpyHostToDevice, stream));
  }

 private:
  std::size_t count_, bytes_;
  Pinned columns_;
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
  const Pinned verdicts(2 * words * sizeof(std::uint32_t));
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
    costs.of[l].needs = needs_of(stream.first_kernel([&] { decide(*lanes[l]); }));
  }
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      const double resident = stream.time([&] {
        for (int k = 0; k < kLaunches; ++k) decide(*lanes[l]);
      });
      const double with_copies = stream.time([&] {
        bring(*lanes[l]);
        decide(*lanes[l]);
        check(cudaMemcpyAsync(verdicts.as<void>(), intersects, 2 * words * sizeof *intersects, cudaMemcpyDeviceToHost,
                              stream));
      });
      costs.of[l].resident.push_back(resident / kLaunches / static_cast<double>(count));
      costs.of[l].with_copies.push_back(with_copies / static_cast<double>(count));
    }
  }
  return costs;
}

}  // namespace graze::cuda
