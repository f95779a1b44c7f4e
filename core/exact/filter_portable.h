// SPDX-License-Identifier: Apache-2.0
// The filter for every compiler and for devices; see core/exact/filter.h. The tests of a against b and of b against a
// are the same computation, so they are done at once.
#pragma once

#include "core/exact/error_bound.h"
#include "core/exact/sides.h"
#include "core/exact/vector.h"

namespace graze::exact::detail::portable {

struct Two {
  double part[2];
  GRAZE_HD double operator[](int i) const { return part[i]; }
  GRAZE_HD Two operator-() const { return {-part[0], -part[1]}; }
  GRAZE_HD friend Two operator+(Two l, Two r) { return {l[0] + r[0], l[1] + r[1]}; }
  GRAZE_HD friend Two operator-(Two l, Two r) { return {l[0] - r[0], l[1] - r[1]}; }
  GRAZE_HD friend Two operator*(Two l, Two r) { return {l[0] * r[0], l[1] * r[1]}; }
};
GRAZE_HD inline unsigned exceeds(const Two& x, const Two& bound) {
  return unsigned{x[0] > bound[0]} | unsigned{x[1] > bound[1]} << 1;
}

GRAZE_HD inline Two exchanged(const Two& x) { return Two{x[1], x[0]}; }

template <class Real>
GRAZE_HD Vec<Two> both(const Vec<Real>& l, const Vec<Real>& r) {
  return {Two{double(l.x), double(r.x)}, Two{double(l.y), double(r.y)}, Two{double(l.z), double(r.z)}};
}

template <class Real>
GRAZE_HD Finding filter(const Real* a, const Real* b) {
  const double error = determinant_error<Real>(extent_of(a, b));
  const Two bound = {error, error};
  const Vec<Two> v[3] = {both(vertex(a, 0), vertex(b, 0)), both(vertex(a, 1), vertex(b, 1)),
                         both(vertex(a, 2), vertex(b, 2))};
  const Vec<Two> n = cross<Two>(v[1] - v[0], v[2] - v[0]);
  unsigned above[3], below[3];  // for each index: bit 0 is b's vertex, bit 1 is a's
  for (int i = 0; i < 3; ++i) {
    const Two height = dot<Two>(n, Vec<Two>{exchanged(v[i].x), exchanged(v[i].y), exchanged(v[i].z)} - v[0]);
    above[i] = exceeds(height, bound);
    below[i] = exceeds(-height, bound);
  }
  if (((above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2])) != 0) return Finding::disjoint;
  if (((above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2])) != 3) return Finding::unsure;

  const unsigned above_a = above[0] >> 1 | (above[1] >> 1) << 1 | (above[2] >> 1) << 2;
  const unsigned above_b = (above[0] & 1) | (above[1] & 1) << 1 | (above[2] & 1) << 2;
  const Turn turn = lone_vertices({above_a, 7 & ~above_a, 0}, {above_b, 7 & ~above_b, 0});
  const Vec<Real> a0 = vertex(a, turn.a[0]), b0 = vertex(b, turn.b[0]);
  const Vec<Two> o = both(vertex(a, turn.a[1]), a0), p = both(b0, b0), q = both(a0, vertex(a, turn.a[2])),
                 r = both(vertex(b, turn.b[1]), vertex(b, turn.b[2]));
  const Two height = dot<Two>(cross<Two>(p - o, q - o), r - o);
  if (exceeds(height, bound) != 0) return Finding::disjoint;
  return exceeds(-height, bound) == 3 ? Finding::crosses : Finding::unsure;
}

}  // namespace graze::exact::detail::portable
