// SPDX-License-Identifier: Apache-2.0
// The strata that exist only in doubles (strata/double_strata.inc lists them). These strata draw numbers like those in
// maps, drawings and constructions, and pairs that float32 cannot store.
#pragma once

#include "core/exact/exact.h"
#include "strata/contact.h"
#include "strata/coplanar.h"

namespace graze::strata {
inline namespace GRAZE_FP {

// Like exact_contact, but with integers of `bits` bits. Half of the contacts are exact; in the other half, a coordinate
// of b[0] is one unit off.
// Requires: 7 <= bits.
GRAZE_HD inline Draft draw_integer_contact(DoubleDraws& draws, int bits) {
  const Touch touch = static_cast<Touch>(draws.below(3));
  const int step_bits = draws.between(bits < 12 ? 1 : bits - 10, bits - 5);
  const Grain<DoubleDraws> grain{(std::int64_t{1} << (bits - 1)) - 2, std::int64_t{1} << step_bits, 8};
  Draft draft = draw_contact(draws, touch, grain).draft;
  if (draws.coin()) {
    const double unit = draws.sign();
    component(draft.b[0], draws.between(0, 2)) += unit;
  }
  return draft;
}

GRAZE_HD inline DoublePair lattice_15(DoubleDraws& draws) {
  const int bits = draws.between(7, 15);
  return shuffled(draws, rounded(draws, draw_integer_contact(draws, bits)));
}

GRAZE_INLINE double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

GRAZE_HD inline DoublePair large_offset(DoubleDraws& draws) {
  Contact contact = draw_contact(draws, draw_touch(draws), real_grain(draws));
  const Push push = draw_push(draws);
  move(contact.draft.b, contact.away * push.gap);
  const double size = 0.1 + 0.9 * draws.positive();
  scale(contact.draft, size / power_of_ten(draws.between(1, 3)));
  const double far = power_of_ten(draws.between(5, 7));
  const Vec to = draws.reals();
  move(contact.draft, normalised(to) * far);
  return finished(draws, contact.draft, push);
}

// A contact or a coplanar pair in float32, rotated by an integer quaternion's matrix and then moved. Each entry of the
// matrix is rounded once.
GRAZE_HD inline DoublePair float_born(DoubleDraws& draws) {
  Draws of_floats = draws;
  const std::uint32_t kind = of_floats.below(3);
  const Pair born = kind == 0   ? near_contact(of_floats, draw_touch(of_floats))
                    : kind == 1 ? exact_contact(of_floats)
                                : coplanar_wide(of_floats);
  static_cast<Draws&>(draws) = of_floats;
  const double w = draws.integer(9), x = draws.integer(9), y = draws.integer(9), z = draws.integer(9);
  const double square = w * w + x * x + y * y + z * z, size = square > 0 ? square : 1;
  const Vec rows[3] = {
      {(w * w + x * x - y * y - z * z) / size, 2 * (x * y - w * z) / size, 2 * (x * z + w * y) / size},
      {2 * (x * y + w * z) / size, (w * w - x * x + y * y - z * z) / size, 2 * (y * z - w * x) / size},
      {2 * (x * z - w * y) / size, 2 * (y * z + w * x) / size, (w * w - x * x - y * y + z * z) / size}};
  const double far = power_of_two(draws.between(0, 10));
  const Vec offset = draws.reals() * far;
  const auto moved = [&](const Vec3<float>& v) {
    const Vec at{v.x, v.y, v.z};
    return Vec{dot(rows[0], at), dot(rows[1], at), dot(rows[2], at)} + offset;
  };
  DoublePair pair;
  for (int i = 0; i < 3; ++i) {
    pair.a[i] = moved(born.a[i]);
    pair.b[i] = moved(born.b[i]);
  }
  return pair;
}

GRAZE_HD inline DoublePair decimal_born(DoubleDraws& draws) {
  const int bits = draws.between(12, 30);
  Draft draft = draw_integer_contact(draws, bits);
  const double unit = power_of_ten(draws.between(3, 6));  // a single division gives the double nearest to the decimal
  for (int i = 0; i < 3; ++i) {
    draft.a[i] = {draft.a[i].x / unit, draft.a[i].y / unit, draft.a[i].z / unit};
    draft.b[i] = {draft.b[i].x / unit, draft.b[i].y / unit, draft.b[i].z / unit};
  }
  return shuffled(draws, rounded(draws, draft));
}

// B's first vertex is a point on an edge or the face of A, or the point where a line crosses A's plane. In half of the
// pairs, a vertex of A is the same point computed in another way, as happens in a model when two constructions meet.
GRAZE_HD inline DoublePair construction_born(DoubleDraws& draws) {
  Draft draft;
  for (Vec& v : draft.a) v = draws.reals();
  const Vec p = draft.a[0], q = draft.a[1], r = draft.a[2];
  const double s = draws.positive(), t = draws.positive();
  Vec first, second;
  switch (draws.below(4)) {
    case 0:  // a midpoint
      first = (p + q) * 0.5;
      second = p + (q - p) * 0.5;
      break;
    case 1:  // a point on an edge
      first = p + (q - p) * t;
      second = q + (p - q) * (1 - t);
      break;
    case 2:  // a point on the face
      first = p + (q - p) * (s * 0.5) + (r - p) * (t * 0.5);
      second = p * (1 - s * 0.5 - t * 0.5) + q * (s * 0.5) + r * (t * 0.5);
      break;
    default: {  // the point where a line crosses the plane
      const Vec n = cross(q - p, r - p), from = draws.reals(), to = draws.reals();
      const double above = dot(n, from - p), below = dot(n, to - p);
      const double share = above == below ? 0.5 : above / (above - below);
      first = from + (to - from) * share;
      second = to + (from - to) * (above == below ? 0.5 : below / (below - above));
      break;
    }
  }
  draft.b[0] = first;
  const Vec side = cross(q - p, r - p);
  const bool same_side = draws.coin();
  draft.b[1] = first + toward(side, draws.reals());
  draft.b[2] = first + toward(side, draws.reals()) * (same_side ? 1.0 : -1.0);
  if (draws.coin()) draft.a[draws.between(0, 2)] = second;
  return shuffled(draws, rounded(draws, draft));
}

// A near contact whose gap is about as large as the spacing of float32 numbers at the contact. Draws up to 32 contacts
// and takes the first whose verdict changes in float32; if none does, which is rare, takes the last.
GRAZE_HD inline DoublePair stored(DoubleDraws& draws) {
  DoublePair pair{};
#ifndef __CUDA_ARCH__
  for (int attempt = 0; attempt < 32; ++attempt) {
    Contact contact = draw_contact(draws, draw_touch(draws), real_grain(draws));
    const double sign = draws.sign();
    move(contact.draft.b, contact.away * (sign * power_of_two(-draws.between(24, 40))));
    const Vec to = draws.reals();
    const double offset = draws.coin() ? 0 : power_of_two(draws.between(0, 12));
    move(contact.draft, to * offset);
    pair = rounded(draws, contact.draft);
    Pair in_float32;
    for (int i = 0; i < 3; ++i) {
      in_float32.a[i] = rounded(pair.a[i]);
      in_float32.b[i] = rounded(pair.b[i]);
    }
    if (exact::intersects(&pair.a[0].x, &pair.b[0].x) != exact::intersects(&in_float32.a[0].x, &in_float32.b[0].x))
      break;
  }
#endif
  return shuffled(draws, pair);
}

// Coordinates are longitude and latitude in radians, and height in Earth radii.
GRAZE_HD inline DoublePair radians(DoubleDraws& draws) {
  Contact contact = draw_contact(draws, draw_touch(draws), real_grain(draws));
  const Push push = draw_push(draws);
  move(contact.draft.b, contact.away * push.gap);
  scale(contact.draft, 1e-5 * draws.positive());  // edges stay under 6e-5
  const double longitude = draws.real() * 3.141592653589793, latitude = draws.real() * 1.5707963267948966,
               height = draws.positive() * 1e-3;
  move(contact.draft, {longitude, latitude, height});
  return finished(draws, contact.draft, push);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
