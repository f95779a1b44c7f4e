// SPDX-License-Identifier: Apache-2.0
// Machine code of PTX, from a toolkit's ptxas. It shows without a device that two PTX texts are the same program.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace graze::cuda {

// Reads the machine code of each kernel from a cubin (an ELF file), keyed by kernel name: the sections .text.KERNEL.
// Throws: std::runtime_error when the file is truncated.
std::map<std::string, std::string> read_cubin(const std::filesystem::path& file);

// The first ptxas in CUDA_HOME, CUDA_PATH, the toolkit of `library` (NVRTC), the PATH or /usr/local/cuda. Empty when
// there is none.
std::filesystem::path find_ptxas(const std::filesystem::path& library);

// Assembles for sm_90; `scratch` is a folder.   Throws: std::runtime_error with the first line of ptxas's output.
std::map<std::string, std::string> assemble(const std::filesystem::path& ptxas, const std::string& ptx,
                                            const std::filesystem::path& scratch);

}  // namespace graze::cuda
