// SPDX-License-Identifier: Apache-2.0
// Runs the kernels of a PTX text on the device, for tests that compare PTX operations with their twins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace graze::cuda {

// Runs the kernel with the parameters (inputs, slots), and one thread for each of the `count` inputs of `input_bytes`
// bytes. Returns: the words that the threads write, `slots` for each thread. Throws: std::runtime_error on any CUDA
// error.   Requires: a device.
std::vector<std::uint64_t> run_ptx(const std::string& ptx, const std::string& kernel, const void* inputs,
                                   std::size_t count, std::size_t input_bytes, std::size_t slots);

}  // namespace graze::cuda
