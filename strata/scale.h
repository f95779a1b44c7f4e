// SPDX-License-Identifier: Apache-2.0
// Contacts at scales that strain the coordinate type: far from the origin, near overflow and underflow, and with very
// different scales in one pair. Each function transforms a contact, and then rounds it once.
#pragma once

#include "strata/contact.h"

namespace graze::strata {
inline namespace GRAZE_FP {

GRAZE_HD inline auto far_from_origin(auto& draws) {
  Contact contact = draw_contact(draws, draw_touch(draws), real_grain(draws));
  const Push push = draw_push(draws);
  move(contact.draft.b, contact.away * push.gap);
  // The offset is log-uniform in 2^7 … 2^23, which is 1.3e2 … 8.4e6 (doubles: 2^7 … 2^51).
  const Vec direction = normalised(draws.reals());
  const double fraction = 1 + draws.positive();
  const Vec offset = direction * (fraction * power_of_two(draws.between(7, draws.kOffset)));
  move(contact.draft, offset);
  return finished(draws, contact.draft, push);
}

// Half of the pairs are near contacts. The other half are exact contacts, unless rounding makes coordinates subnormal.
GRAZE_HD inline auto extreme_scale(auto& draws) {
  const bool exact = draws.coin();
  const auto grain = exact ? wide_grain(draws) : real_grain(draws);
  Contact contact = draw_contact(draws, draw_touch(draws), grain);
  Push push = draw_push(draws);
  if (exact) push.gap = 0;
  move(contact.draft.b, contact.away * push.gap);
  // Contacts reach 3 (reals) or 2^24 (integers; doubles: 2^53), so the largest coordinate stays below 2^128 (doubles:
  // 2^1024). Scaling takes two steps, because no double is a power of two below 2^-1074. The first step is exact.
  const int exponent = draws.between(draws.kLeastScale, draws.kMostScale) - (exact ? draws.kBits - 1 : 0);
  for (const int part : {exponent / 2, exponent - exponent / 2}) scale(contact.draft, power_of_two(part));
  return finished(draws, contact.draft, push);
}

GRAZE_HD inline auto mixed_scale(auto& draws) {
  Contact contact = draw_contact(draws, draw_touch(draws), real_grain(draws));
  Push push = draw_push(draws);
  Draft& draft = contact.draft;
  if (draws.coin()) {  // scale each axis differently, which preserves the contact
    const Vec size{power_of_two(draws.integer(draws.kRatio)), power_of_two(draws.integer(draws.kRatio)),
                   power_of_two(draws.integer(draws.kRatio))};
    move(draft.b, contact.away * push.gap);
    scale(draft, size);
    return finished(draws, draft, push);
  }
  // Shrinks one triangle, and the gap, towards the contact.
  const double size = power_of_two(-draws.between(1, draws.kGap));
  const bool shrink_a = draws.coin();
  move(draft, contact.p * -1.0);
  scale(shrink_a ? draft.a : draft.b, {size, size, size});
  move(draft.b, contact.away * (push.gap * size));
  // If the contact is at the origin, the small triangle keeps its digits; at other places, its coordinates are rounded
  // to the spacing of the large triangle's coordinates.
  if (draws.below(4) == 0) move(draft, contact.p);
  return finished(draws, draft, push);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
