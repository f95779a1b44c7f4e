// SPDX-License-Identifier: Apache-2.0
// Subjects in OpenCL C. graze-subject-opencl builds and runs them, in four modes of the device's compiler.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "subjects/code_hash.h"
#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

inline constexpr std::uint64_t kDriverMemory = 8192;  // MiB; a device's driver needs more than host code does

// The toolchains opencl, opencl-nofma, opencl-mad and opencl-fast. Their `run` starts graze-subject-opencl.
std::vector<Toolchain> opencl_toolchains(const std::string& function);

// Compiles the source once, to see whether the device's compiler accepts it.   run: the toolchain's. Returns: the
// source itself as the build, because the runner loads the source. The build's name is a hash of the source, `run` and
// the devices.   Throws: std::runtime_error with the compiler's first error, or if there is no device; Stopped.
Built built_for_opencl(const std::filesystem::path& source, const std::shared_ptr<const SealedCopy>& content,
                       const std::string& run);

}  // namespace graze::subjects
