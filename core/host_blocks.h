// SPDX-License-Identifier: Apache-2.0
// The host lanes' block functions, a table a build variant: [algorithm][scalar].
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "core/lanes.h"

namespace graze {

using HostBlocks = std::array<std::array<DecideBlock, 2>, kAlgorithmCount>;
extern const HostBlocks kBlocksCpu;
extern const HostBlocks kBlocksCpuFma;

}  // namespace graze
