// SPDX-License-Identifier: Apache-2.0
// What runs the build of a user's CUDA source: a device, or the build's twin.
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

// The build's twin as it was kept; null if it has none.   Throws: std::runtime_error if its file has changed since.
std::shared_ptr<const SealedCopy> twin_of(const cuda::CudaBuild& build);

// The code for a device or, without one, for the twin. Its `what` is empty if there is neither.
Code code_of(const cuda::CudaBuild& build, const Wanted& wanted, bool on_device,
             std::shared_ptr<const SealedCopy> twin);

// What the kernels of builds cost on this machine's device.
struct KernelCosts {
  std::string device;
  std::vector<std::vector<double>> nanoseconds;  // per pair: for each build, one number per pass; none is empty
};
inline constexpr std::uint32_t kPairsOfKernelCosts = 1u << 20;  // of the stratum `uniform`, in device memory already

// Measures in a process of its own, for at most a minute.   Throws: std::runtime_error that says why there is no cost,
// such as a missing device; Stopped.
KernelCosts kernel_costs(std::span<const cuda::CudaBuild* const> builds);

}  // namespace graze::subjects
