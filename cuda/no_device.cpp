// SPDX-License-Identifier: Apache-2.0
// Stands in for device.cu where there is no nvcc: the CUDA lanes are listed, and unavailable.
#include "cuda/device.h"

namespace graze {

std::unique_ptr<Device> open_device(std::string& why_not) {
  why_not = "built without CUDA";
  return nullptr;
}

}  // namespace graze
