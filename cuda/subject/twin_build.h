// SPDX-License-Identifier: Apache-2.0
// From the PTX of one kernel to its twin as a shared library: generated, compiled by the host's compiler, kept.
#pragma once

#include <filesystem>
#include <string>

#include "core/lanes/lanes.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda {

// The shared library of the module's one kernel in `cache`, built when it is not there yet; subject.h's graze_subject
// and what cuda/twin/twin_library.h reads. Its name is a hash of its source, the compiler and its flags.
// Throws: twin::PtxError for an instruction that cannot be replayed, std::runtime_error when the compiler fails.
std::filesystem::path build_twin(const twin::Module& module, Scalar scalar, bool contracted,
                                 const std::filesystem::path& cache);

}  // namespace graze::cuda
