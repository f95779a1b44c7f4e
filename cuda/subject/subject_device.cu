// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/subject_device.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "cuda/lanes/device.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/stratum_kernels.cuh"
#include "cuda/twin/twin_library.h"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

constexpr unsigned kBlock = 1u << 22;  // pairs in one block: 302 MB of float coordinates
constexpr unsigned kThreadsOfBlock = 256;
constexpr std::size_t kStackBytes = 16384;  // stack per thread, for recursion

__global__ void widen(const float* from, double* to, std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) to[i] = from[i];
}

unsigned blocks_of(std::size_t threads) {
  return static_cast<unsigned>((threads + kThreadsOfBlock - 1) / kThreadsOfBlock);
}

class Subject final : public SubjectOnDevice {
 public:
  explicit Subject(const CudaBuild& build) : scalar_(build.scalar) {
    check(cudaDeviceSetLimit(cudaLimitStackSize, kStackBytes));
    check(cudaLibraryLoadData(&library_, build.ptx.c_str(), nullptr, nullptr, 0, nullptr, nullptr, 0));
    check(cudaLibraryGetKernel(&kernel_, library_, kSubjectKernel));
  }
  ~Subject() override { cudaLibraryUnload(library_); }

  void decide(std::span<const Pair> pairs, std::int8_t* answers) override { decide_all(pairs, floats_, answers); }
  void decide(std::span<const DoublePair> pairs, std::int8_t* answers) override {
    decide_all(pairs, doubles_, answers);
  }

  // Decides n pairs. coordinates: 18 arrays of n coordinates in device memory.
  template <class Real>
  void decide_block(const Real* coordinates, unsigned n, std::int8_t* answers) {
    launch(in_its_type(coordinates, n), n);
    check(cudaMemcpy(answers, answers_.at_least(n), n, cudaMemcpyDeviceToHost));
  }

  // The coordinates in the type of the kernel's function: unchanged, or converted to doubles.
  const void* in_its_type(const float* coordinates, unsigned n) {
    if (scalar_ == Scalar::f32) return coordinates;
    const std::size_t count = std::size_t{n} * kCoordinates;
    double* wide = wide_.at_least(count);
    widen<<<blocks_of(count), kThreadsOfBlock>>>(coordinates, wide, count);
    check(cudaGetLastError());
    return wide;
  }
  const void* in_its_type(const double* coordinates, unsigned) {
    if (scalar_ != Scalar::f64) throw std::logic_error("a kernel of floats cannot decide doubles");
    return coordinates;
  }

  void launch(const void* from, unsigned n) {
    signed char* answers_at = answers_.at_least(n);
    void* arguments[] = {&from, &n, &n, &answers_at};
    check(cudaLaunchKernel(reinterpret_cast<const void*>(kernel_), dim3(blocks_of(n)), dim3(kThreadsOfBlock), arguments,
                           0, nullptr));
  }

 private:
  template <class Real>
  void decide_all(std::span<const BasicPair<Real>> pairs, DeviceArray<Real>& on_device, std::int8_t* answers) {
    std::vector<Real> columns;
    for (std::size_t first = 0; first < pairs.size(); first += kBlock) {
      const auto n = static_cast<unsigned>(std::min<std::size_t>(kBlock, pairs.size() - first));
      columns.resize(std::size_t{n} * kCoordinates);
      for (unsigned i = 0; i < n; ++i) {
        for (unsigned c = 0; c < kCoordinates; ++c) columns[std::size_t{c} * n + i] = coordinates(pairs[first + i])[c];
      }
      Real* at = on_device.at_least(columns.size());
      check(cudaMemcpy(at, columns.data(), columns.size() * sizeof(Real), cudaMemcpyHostToDevice));
      decide_block(at, n, answers + first);
    }
  }

  Scalar scalar_;
  cudaLibrary_t library_ = nullptr;
  cudaKernel_t kernel_ = nullptr;
  DeviceArray<float> floats_;
  DeviceArray<double> doubles_, wide_;
  DeviceArray<signed char> answers_;
};

// Copies the pairs of a block, which the kernels have decided, from the device.
template <class Real>
void fetch(const Real* on_device, std::vector<BasicPair<Real>>& pairs) {
  std::vector<Real> columns(pairs.size() * kCoordinates);
  check(cudaMemcpy(columns.data(), on_device, columns.size() * sizeof(Real), cudaMemcpyDeviceToHost));
  tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
    for (std::size_t c = 0; c < kCoordinates; ++c) coordinates(pairs[i])[c] = columns[c * pairs.size() + i];
  });
}

template <class Real>
void compare(Subject& subject, const TwinLibrary& twin, const Real* on_device, std::span<const BasicPair<Real>> pairs,
             std::uint64_t first, StratumProof& row) {
  std::vector<std::int8_t> there(pairs.size()), here(pairs.size());
  subject.decide_block(on_device, static_cast<unsigned>(pairs.size()), there.data());
  twin.decide(pairs, here.data());
  row.pairs += pairs.size();
  row.twin_pairs += pairs.size();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (there[i] == here[i]) continue;
    ++row.twin_verdict_differences;
    if (row.examples.size() < kExamples) row.examples.push_back(first + i);
  }
}

}  // namespace

std::unique_ptr<SubjectOnDevice> open_on_device(const CudaBuild& build) {
  std::string why_not;
  if (!open_device(why_not)) throw std::runtime_error("cannot run your CUDA code on a device: " + why_not);
  return std::make_unique<Subject>(build);
}

SubjectCosts time_subjects(std::span<const CudaBuild> builds, std::uint32_t count, int passes) {
  constexpr int kLaunches = 4;  // launches timed together, because each launch costs a few microseconds
  std::string why_not;
  const auto device = open_device(why_not);
  if (!device) throw std::runtime_error(why_not);
  DeviceArray<float> drawn;
  float* coordinates = drawn.at_least(std::size_t{count} * kCoordinates);
  launch_generate(coordinates, count, 1, static_cast<int>(strata::Stratum::uniform), 0, nullptr);
  check(cudaGetLastError());
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<const void*> from;
  for (const CudaBuild& build : builds) {
    subjects.push_back(std::make_unique<Subject>(build));
    from.push_back(subjects.back()->in_its_type(coordinates, count));
    subjects.back()->launch(from.back(), count);  // the first launch allocates memory and loads the kernel
  }
  check(cudaDeviceSynchronize());
  SubjectCosts costs{device->name, std::vector<std::vector<double>>(builds.size())};
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t b = 0; b < builds.size(); ++b) {
      const double milliseconds = timed(nullptr, [&] {
        for (int k = 0; k < kLaunches; ++k) subjects[b]->launch(from[b], count);
      });
      costs.nanoseconds[b].push_back(milliseconds * 1e6 / kLaunches / count);
    }
  }
  return costs;
}

ProofRecord prove_subjects(std::span<const NamedBuild> builds, const ProofOptions& options) {
  std::string why_not;
  const auto device = open_device(why_not);
  if (!device) throw std::runtime_error("a proof needs a device: " + why_not);
  const auto start = std::chrono::steady_clock::now();
  ProofRecord record;
  record.device = device->name;
  record.driver = device->driver;
  record.seed = options.seed;
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<std::unique_ptr<TwinLibrary>> twins;
  for (const auto& [lane, build] : builds) {
    if (build->twin.empty() || (options.of_doubles && build->scalar != Scalar::f64)) continue;
    record.toolkit = build->toolkit;
    subjects.push_back(std::make_unique<Subject>(*build));
    twins.push_back(std::make_unique<TwinLibrary>(build->twin, build->scalar));
    record.lanes.push_back({lane, build->hash, "", {}});
  }
  Drawing drawing;
  DeviceArray<float> floats;
  DeviceArray<double> doubles;
  for (const strata::PairSource& source : strata::stratum_sources(
           options.seed, options.twin_pairs, {}, options.of_doubles ? PairTypes::f64 : PairTypes::f32)) {
    for (LaneProof& lane : record.lanes) lane.strata.push_back({source.id});
    const auto prove_blocks = [&]<class Real>(DeviceArray<Real>& room) {
      for (std::uint64_t first = 0; first < source.pairs; first += kBlock) {
        std::vector<BasicPair<Real>> pairs(std::min<std::uint64_t>(kBlock, source.pairs - first));
        Real* on_device = room.at_least(pairs.size() * kCoordinates);
        drawing.draw(source, first, static_cast<std::uint32_t>(pairs.size()), on_device, nullptr);
        fetch(on_device, pairs);
        for (std::size_t l = 0; l < record.lanes.size(); ++l)
          compare<Real>(*subjects[l], *twins[l], on_device, pairs, first, record.lanes[l].strata.back());
      }
    };
    source.in_doubles() ? prove_blocks(doubles) : prove_blocks(floats);
    record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (options.progress) options.progress(source.id + ": " + std::to_string(source.pairs) + " pairs");
  }
  return record;
}

}  // namespace graze::cuda
