// SPDX-License-Identifier: Apache-2.0
// Assembles PTX with a toolkit's ptxas. Machine code shows, without a device, whether two PTX texts are one program.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace graze::cuda {

// Reads each kernel's machine code, by kernel name, from a cubin (an ELF file): the sections .text.KERNEL.
// Throws: std::runtime_error if the file is missing or truncated.
std::map<std::string, std::string> read_cubin(const std::filesystem::path& file);

// The first ptxas in CUDA_HOME, CUDA_PATH, the toolkit of `library` (NVRTC), the PATH or /usr/local/cuda; empty if
// there is none.
std::filesystem::path find_ptxas(const std::filesystem::path& library);

// Assembles the PTX for sm_90 in the folder `scratch`.   Returns: machine code by kernel name.
// Throws: std::runtime_error with the first line of ptxas's output.
std::map<std::string, std::string> assemble(const std::filesystem::path& ptxas, const std::string& ptx,
                                            const std::filesystem::path& scratch);

}  // namespace graze::cuda
