// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace graze::cuda {

// CUDA failed. out_of_memory: of the device, or of pinned memory.
struct DeviceFailure : std::runtime_error {
  DeviceFailure(const std::string& what, bool out) : std::runtime_error(what), out_of_memory(out) {}
  bool out_of_memory;
};

}  // namespace graze::cuda
