// SPDX-License-Identifier: Apache-2.0
// A pair's exact relation: the record of truth that the exact decision, oracle, engines and reports share.
#pragma once

#include <compare>
#include <cstdint>

#include "core/exact/host_device.h"

namespace graze {

// declined: a coordinate is not finite (oracle), or the lane cannot decide; it is never reported as another verdict.
// crashed, timed_out, unstable: foreign code ended its process, did not return, or answered differently when it was
// asked again.
enum class Verdict : std::uint8_t { disjoint, intersects, declined, crashed, timed_out, unstable };

// Dimension of the common set of two closed convex hulls; unknown if the oracle declined.
enum class Contact : std::uint8_t { none, point, segment, area, unknown };

// The contact of a common set of this dimension: 0 point, 1 segment, 2 area.
GRAZE_HD constexpr Contact contact_of(int dimension) { return static_cast<Contact>(dimension + 1); }

// The convex hulls of a pair's triangles.
struct Hulls {
  int dimension_a = 2;  // 0 point, 1 segment, 2 triangle
  int dimension_b = 2;
  bool coplanar = false;  // one plane holds all six points
  auto operator<=>(const Hulls&) const = default;
};

struct Relation {
  Verdict verdict = Verdict::disjoint;
  Contact contact = Contact::none;
  int margin_sign = 1;  // 1: disjoint; -1: they intersect and no arbitrarily small translation separates them; else 0
  Hulls hulls;

  GRAZE_HD constexpr bool intersects() const { return verdict == Verdict::intersects; }
  constexpr bool touches() const { return intersects() && margin_sign == 0; }
  friend bool operator==(const Relation&, const Relation&) = default;
};

// Packs contact and hulls into seven bits.   Requires: a known contact.
GRAZE_HD constexpr std::uint8_t packed(const Relation& r) {
  return static_cast<std::uint8_t>(r.hulls.dimension_a | r.hulls.dimension_b << 2 | int{r.hulls.coplanar} << 4 |
                                   static_cast<int>(r.contact) << 5);
}

// The inverse of `packed`. The margin's sign must be given, because it is not packed.
constexpr Relation unpacked_relation(std::uint8_t bits, int margin_sign) {
  const auto contact = static_cast<Contact>(bits >> 5 & 3);
  return {contact == Contact::none ? Verdict::disjoint : Verdict::intersects,
          contact,
          margin_sign,
          {bits & 3, bits >> 2 & 3, (bits >> 4 & 1) != 0}};
}

}  // namespace graze
