// SPDX-License-Identifier: Apache-2.0
// What runs the build of a user's CUDA source: a device, or the build's twin.
#pragma once

#include <memory>

#include "cuda/subject/cuda_subject.h"
#include "subjects/process.h"
#include "subjects/subjects.h"

namespace graze::subjects {

// The build's twin as it was kept; null if it has none.   Throws: std::runtime_error if its file has changed since.
std::shared_ptr<const SealedCopy> twin_of(const cuda::CudaBuild& build);

// The code for a device or, without one, of the twin. Its `what` is empty if there is neither.
Code code_of(const cuda::CudaBuild& build, const Wanted& wanted, bool on_device,
             std::shared_ptr<const SealedCopy> twin);

}  // namespace graze::subjects
