// SPDX-License-Identifier: Apache-2.0
// What a lane or the oracle says of a pair, and the words for it in every output.
#pragma once

#include <cstdint>
#include <string_view>

namespace graze {

// declined: a non-finite coordinate (oracle), or a lane that cannot decide; never silently one of the others.
// crashed, timed_out, unstable: foreign code that ended its process, did not return, or answered otherwise when it was
// asked again.
enum class Verdict : std::uint8_t { disjoint, intersects, declined, crashed, timed_out, unstable };

// Whether it is of foreign code that failed.
constexpr bool is_failure(Verdict verdict) { return verdict >= Verdict::crashed; }

// Dimension of the common set of two closed convex hulls; unknown where the oracle declined.
enum class Contact : std::uint8_t { none, point, segment, area, unknown };

constexpr std::string_view name(Verdict verdict) {
  constexpr std::string_view kNames[] = {"disjoint", "intersects", "declined", "crashed", "timed_out", "unstable"};
  return kNames[static_cast<int>(verdict)];
}

constexpr std::string_view name(Contact contact) {
  constexpr std::string_view kNames[] = {"none", "point", "segment", "area", "unknown"};
  return kNames[static_cast<int>(contact)];
}

}  // namespace graze
