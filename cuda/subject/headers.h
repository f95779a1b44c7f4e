// SPDX-License-Identifier: Apache-2.0
// Stand-ins for standard headers that device code often includes. NVRTC does not have them; their device functions are
// built into NVRTC or defined here.
#pragma once

#include <span>

namespace graze::cuda {

struct StubHeader {
  const char* name;
  const char* text;
};

std::span<const StubHeader> stub_headers();

}  // namespace graze::cuda
