// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace graze::cuda {

// The failure of a CUDA call. out_of_memory: there was not enough device memory or pinned host memory.
struct DeviceFailure : std::runtime_error {
  DeviceFailure(const std::string& what, bool out) : std::runtime_error(what), out_of_memory(out) {}
  bool out_of_memory;
};

}  // namespace graze::cuda
