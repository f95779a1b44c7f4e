// SPDX-License-Identifier: Apache-2.0
// The verdict of a lane or the oracle on a pair, the exact relation of a pair, and the words for both in every output.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/exact/relation.h"

namespace graze {

// Whether it is of foreign code that failed.
constexpr bool is_failure(Verdict verdict) { return verdict >= Verdict::crashed; }

constexpr std::string_view name(Verdict verdict) {
  constexpr std::string_view kNames[] = {"disjoint", "intersects", "declined", "crashed", "timed_out", "unstable"};
  return kNames[static_cast<int>(verdict)];
}

constexpr std::string_view name(Contact contact) {
  constexpr std::string_view kNames[] = {"none", "point", "segment", "area", "unknown"};
  return kNames[static_cast<int>(contact)];
}

}  // namespace graze
