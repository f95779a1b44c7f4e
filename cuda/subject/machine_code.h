// SPDX-License-Identifier: Apache-2.0
// Machine code of PTX, by the ptxas of a toolkit: what shows without a device that two texts of PTX are one program.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace graze::cuda {

// The machine code in a cubin, an ELF file, by the names of its kernels: the sections .text.KERNEL.
// Throws: std::runtime_error for a file that ends early.
std::map<std::string, std::string> read_cubin(const std::filesystem::path& file);

// The ptxas of CUDA_HOME, of the toolkit that `library` (NVRTC) is in, on the PATH or below /usr/local; empty: none.
std::filesystem::path find_ptxas(const std::filesystem::path& library);

// Assembles for sm_90 in `scratch`, a folder.   Throws: std::runtime_error with the first line that ptxas says.
std::map<std::string, std::string> assemble(const std::filesystem::path& ptxas, const std::string& ptx,
                                            const std::filesystem::path& scratch);

}  // namespace graze::cuda
