// SPDX-License-Identifier: Apache-2.0
// The host lanes' block functions, one table for each host variant, in that variant's namespace: [algorithm][scalar].
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "core/lanes.h"

namespace graze {

using HostBlocks = std::array<std::array<DecideBlock::Function, 2>, kAlgorithmCount>;

#define GRAZE_DECLARE_host(name)       \
  namespace name {                     \
  extern const HostBlocks kHostBlocks; \
  }
#define GRAZE_DECLARE_device(name)
#define GRAZE_VARIANT(name, id, runs_on, ...) GRAZE_DECLARE_##runs_on(name)
#include "core/variants.inc"
#undef GRAZE_VARIANT
#undef GRAZE_DECLARE_host
#undef GRAZE_DECLARE_device

}  // namespace graze
