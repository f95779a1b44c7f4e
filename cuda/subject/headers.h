// SPDX-License-Identifier: Apache-2.0
// Stand-ins for headers that device code includes out of habit, and that NVRTC, which has none of a host's, needs not:
// what they declare for a device is built into it, or written here.
#pragma once

#include <span>

namespace graze::cuda {

struct StubHeader {
  const char* name;
  const char* text;
};

std::span<const StubHeader> stub_headers();

}  // namespace graze::cuda
