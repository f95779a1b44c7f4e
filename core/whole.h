// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace graze {

// The limit of pair counts, seeds and indices: 2^53, up to which every JSON reader represents all whole numbers
// exactly.
inline constexpr std::uint64_t kMostWhole = std::uint64_t{1} << 53;

}  // namespace graze
