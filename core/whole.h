// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace graze {

// The largest pair count, seed and index: 2^53. JSON readers represent all whole numbers up to 2^53 exactly.
inline constexpr std::uint64_t kMostWhole = std::uint64_t{1} << 53;

}  // namespace graze
