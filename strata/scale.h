// SPDX-License-Identifier: Apache-2.0
// Contacts at scales that strain float32: far from the origin, near overflow and underflow, and very different scales
// within one pair. Each function transforms a contact before its one rounding.
#pragma once

#include "strata/contact.h"

namespace graze::strata {
inline namespace GRAZE_FP {

GRAZE_HD inline Pair far_from_origin(Draws& draws) {
  Contact contact = draw_contact(draws, draw_touch(draws), real_grain());
  const Push push = draw_push(draws);
  move(contact.draft.b, contact.away * push.gap);
  // 2^7 … 2^23 is 1.3e2 … 8.4e6, log-uniform.
  const Vec direction = normalised(draws.reals());
  const double fraction = 1 + draws.positive();
  const Vec offset = direction * (fraction * power_of_two(draws.between(7, 22)));
  move(contact.draft.a, offset);
  move(contact.draft.b, offset);
  return finished(draws, contact.draft, push);
}

// Half of the pairs are near contacts. The other half are exact, unless they round into the subnormals.
GRAZE_HD inline Pair extreme_scale(Draws& draws) {
  const bool exact = draws.coin();
  const Grain grain = exact ? wide_grain(draws) : real_grain();
  Contact contact = draw_contact(draws, draw_touch(draws), grain);
  Push push = draw_push(draws);
  if (exact) push.gap = 0;
  move(contact.draft.b, contact.away * push.gap);
  // Contacts reach 3 (reals) or 2^24 (integers), so the largest coordinate stays below 2^128.
  const double size = power_of_two(draws.between(-149, 126) - (exact ? 23 : 0));
  scale(contact.draft.a, {size, size, size});
  scale(contact.draft.b, {size, size, size});
  return finished(draws, contact.draft, push);
}

GRAZE_HD inline Pair mixed_scale(Draws& draws) {
  Contact contact = draw_contact(draws, draw_touch(draws), real_grain());
  Push push = draw_push(draws);
  Draft& draft = contact.draft;
  if (draws.coin()) {  // each axis has its own scale; the contact remains one
    const Vec size{power_of_two(draws.integer(20)), power_of_two(draws.integer(20)), power_of_two(draws.integer(20))};
    move(draft.b, contact.away * push.gap);
    scale(draft.a, size);
    scale(draft.b, size);
    return finished(draws, draft, push);
  }
  // One triangle and the gap shrink towards the contact.
  const double size = power_of_two(-draws.between(1, 40));
  const bool shrink_a = draws.coin();
  const Vec to_origin = contact.p * -1.0;
  move(draft.a, to_origin);
  move(draft.b, to_origin);
  scale(shrink_a ? draft.a : draft.b, {size, size, size});
  move(draft.b, contact.away * (push.gap * size));
  // A contact at the origin keeps the small triangle's digits. Elsewhere the small triangle rounds to the large one's
  // grid.
  if (draws.below(4) == 0) {
    move(draft.a, contact.p);
    move(draft.b, contact.p);
  }
  return finished(draws, draft, push);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
