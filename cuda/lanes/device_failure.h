// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace graze::cuda {

// A CUDA call failed. out_of_memory: device memory or pinned host memory ran out.
struct DeviceFailure : std::runtime_error {
  DeviceFailure(const std::string& what, bool out) : std::runtime_error(what), out_of_memory(out) {}
  bool out_of_memory;
};

}  // namespace graze::cuda
