// SPDX-License-Identifier: Apache-2.0
// Names of verdicts and contacts for all output, and which verdicts mean that foreign code failed.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/exact/relation.h"

namespace graze {

// Whether foreign code failed: it crashed, timed out or was unstable.
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
