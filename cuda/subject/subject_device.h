// SPDX-License-Identifier: Apache-2.0
// Builds of a user's CUDA source on a device, and the proof that their twins give the same answers.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/pair.h"
#include "cuda/subject/cuda_subject.h"
#include "cuda/twin/prove.h"

namespace graze::cuda {

// A build that the driver has assembled for the first device. Not thread-safe.
class SubjectOnDevice {
 public:
  virtual ~SubjectOnDevice() = default;

  // Answers for each pair: -1 declined, 0 disjoint, 1 intersects.
  // Throws: std::runtime_error on any CUDA error. After an error that the user's code causes, this process can no
  // longer use the device.
  virtual void decide(std::span<const Pair> pairs, std::int8_t* answers) = 0;
  // Requires: a kernel of doubles.
  virtual void decide(std::span<const DoublePair> pairs, std::int8_t* answers) = 0;
};

// Throws: std::runtime_error without a device, when built without CUDA, or when the driver refuses the PTX.
std::unique_ptr<SubjectOnDevice> open_on_device(const CudaBuild& build);

// Nanoseconds per pair for each build's kernel, on `count` pairs of the stratum `uniform` that are already in device
// memory, one value for each pass. In a pass all builds take turns. Only `scalar` and `ptx` of a build are read.
// Throws: as open_on_device; std::runtime_error if the device does not answer.
struct SubjectCosts {
  std::string device;                            // "NVIDIA H100 80GB HBM3"
  std::vector<std::vector<double>> nanoseconds;  // of each build
};
SubjectCosts time_subjects(std::span<const CudaBuild> builds, std::uint32_t count, int passes);

// Compares each build that has a twin with that twin, on `options.twin_pairs` pairs over all strata. Only functions of
// doubles can take pairs of doubles. In the record, the twin decided all counted pairs, and there are no trace hashes.
// Throws: as open_on_device.
struct NamedBuild {
  std::string lane;  // "mine/f32/cuda-fma"
  const CudaBuild* build;
};
ProofRecord prove_subjects(std::span<const NamedBuild> builds, const ProofOptions& options);

}  // namespace graze::cuda
