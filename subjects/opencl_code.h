// SPDX-License-Identifier: Apache-2.0
// A subject in OpenCL C: graze-subject-opencl builds and runs it, once for each way in which its compiler can contract.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "subjects/code_hash.h"
#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

inline constexpr std::uint64_t kDriverMemory = 8192;  // MiB: a device's driver needs more than code of the host

// opencl, opencl-nofma, opencl-mad and opencl-fast. Their `run` starts graze-subject-opencl.
std::vector<Toolchain> opencl_toolchains(const std::string& function);

// Compiles the source once on the device, to see whether it can.   run: the toolchain's.
// Returns: the source, because that is what is loaded. Its name is a hash of the source, `run` and the device.
// Throws: std::runtime_error with the compiler's first error, or when there is no device; Stopped.
Built built_for_opencl(const std::filesystem::path& source, const std::shared_ptr<const SealedCopy>& content,
                       const std::string& run);

}  // namespace graze::subjects
