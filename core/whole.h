// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace graze {

// The limit of pair counts, seeds and indices: 2^53. Every JSON reader represents all whole numbers up to it exactly.
inline constexpr std::uint64_t kMostWhole = std::uint64_t{1} << 53;

}  // namespace graze
