// SPDX-License-Identifier: Apache-2.0
// Which triangle lies inside the other: all of it if they are coplanar, otherwise its part in the other's plane. Code
// that only looks for crossing edges misses coplanar nesting. find_nesting.h computes the nesting.
#pragma once

#include <cstdint>

#include "core/exact/relation.h"

namespace graze {

// a_in_b, if coplanar: all of a lies in b, boundary included; if not: two proper triangles meet in a segment, the part
// of a in b's plane lies in b, and the part of b in a's plane does not lie in a. same: coplanar and equal.
enum class Nesting : std::uint8_t { none, a_in_b, b_in_a, same };

// Packs relation and nesting into nine bits.   Requires: a known contact.
GRAZE_HD constexpr std::uint16_t packed(const Relation& r, Nesting nesting) {
  return static_cast<std::uint16_t>(packed(r) | static_cast<int>(nesting) << 7);
}
GRAZE_HD constexpr Nesting unpacked_nesting(std::uint16_t bits) { return static_cast<Nesting>(bits >> 7 & 3); }

}  // namespace graze
