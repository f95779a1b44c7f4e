// SPDX-License-Identifier: Apache-2.0
// Builds a twin from a kernel's PTX: generates C++, compiles it with the host's compiler, and caches the shared
// library.
#pragma once

#include <filesystem>
#include <string>

#include "core/lanes/lanes.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda {

// The twin of the module's only kernel: a library in `cache`, which is built if it is missing. The library exports
// graze_subject (see subject.h) and the symbols that cuda/twin/twin_library.h reads. The file name contains a hash of
// the twin's source, the compiler and the flags.
// Throws: twin::PtxError for an instruction that cannot be replayed; std::runtime_error when the compiler fails.
std::filesystem::path build_twin(const twin::Module& module, Scalar scalar, bool contracted,
                                 const std::filesystem::path& cache);

}  // namespace graze::cuda
