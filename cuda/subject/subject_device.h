// SPDX-License-Identifier: Apache-2.0
// Runs builds of a user's CUDA source on a device, and checks that their twins give the same answers.
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

  // Writes an answer for each pair: -1 for declined, 0 for disjoint, 1 for intersects.
  // Throws: std::runtime_error on any CUDA error. After an error in the user's code, this process can no longer use the
  // device at all.
  virtual void decide(std::span<const Pair> pairs, std::int8_t* answers) = 0;
  // Requires: a function that takes doubles.
  virtual void decide(std::span<const DoublePair> pairs, std::int8_t* answers) = 0;
};

// Throws: std::runtime_error without a device, when built without CUDA, or when the driver refuses the PTX.
std::unique_ptr<SubjectOnDevice> open_on_device(const CudaBuild& build);

// Measures each build's kernel on `count` pairs of the stratum `uniform` in device memory, in nanoseconds per pair.
// Each pass measures all builds, one after another. Only a build's `scalar` and `ptx` are used. Throws: as
// open_on_device; std::runtime_error if the device does not answer.
struct SubjectCosts {
  std::string device;                            // "NVIDIA H100 80GB HBM3"
  std::vector<std::vector<double>> nanoseconds;  // for each build, one value for each pass
};
SubjectCosts time_subjects(std::span<const CudaBuild> builds, std::uint32_t count, int passes);

// Compares each build with its twin, if it has one, on `options.twin_pairs` pairs over all strata. Pairs of doubles
// require functions that take doubles. The record has no trace hashes, and the twin decides all counted pairs.
// Throws: as open_on_device.
struct NamedBuild {
  std::string lane;  // "mine/f32/cuda-fma"
  const CudaBuild* build;
};
ProofRecord prove_subjects(std::span<const NamedBuild> builds, const ProofOptions& options);

}  // namespace graze::cuda
