// SPDX-License-Identifier: Apache-2.0
// The code that runs for a build of a user's CUDA source: its PTX on a device, or its twin.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cuda/subject/cuda_subject.h"
#include "subjects/process.h"
#include "subjects/subjects.h"

namespace graze::subjects {

// The build's twin from the cache; null if the build has none.   Throws: std::runtime_error if the twin's file has
// changed since it was built.
std::shared_ptr<const SealedCopy> twin_of(const cuda::CudaBuild& build);

// The build's code for a device if `on_device` is set, otherwise its twin. Without such code, Code::what is empty.
Code code_of(const cuda::CudaBuild& build, const Wanted& wanted, bool on_device,
             std::shared_ptr<const SealedCopy> twin);

// How long the builds' kernels take on this machine's device.
struct KernelCosts {
  std::string device;
  std::vector<std::vector<double>> nanoseconds;  // per pair: for each build, one number per pass
};
inline constexpr std::uint32_t kPairsOfKernelCosts = 1u << 20;  // of stratum `uniform`, in device memory

// Measures the times in a separate process, in at most a minute.   Throws: std::runtime_error with the reason if it
// cannot measure, for example without a device; Stopped.
KernelCosts kernel_costs(std::span<const cuda::CudaBuild* const> builds);

}  // namespace graze::subjects
