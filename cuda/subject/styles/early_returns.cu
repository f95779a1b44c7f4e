// SPDX-License-Identifier: Apache-2.0
// A predicate with many early returns: the interval test of Moller 1997, with divisions.
#include <math.h>

__device__ bool intersects(const float a[9], const float b[9]) {
  const float e[6] = {a[3] - a[0], a[4] - a[1], a[5] - a[2], a[6] - a[0], a[7] - a[1], a[8] - a[2]};
  const float nx = e[1] * e[5] - e[2] * e[4], ny = e[2] * e[3] - e[0] * e[5], nz = e[0] * e[4] - e[1] * e[3];
  const float d = -(nx * a[0] + ny * a[1] + nz * a[2]);
  const float d0 = nx * b[0] + ny * b[1] + nz * b[2] + d;
  const float d1 = nx * b[3] + ny * b[4] + nz * b[5] + d;
  const float d2 = nx * b[6] + ny * b[7] + nz * b[8] + d;
  if (d0 * d1 > 0.0f && d0 * d2 > 0.0f) return false;
  if (d0 == 0 && d1 == 0 && d2 == 0) return fabsf(nx) < fabsf(ny);
  if (nx != nx) return false;
  const bool first = d0 * d1 > 0.0f;
  const float lone = first ? d2 : d0, left = first ? d0 : d1, right = first ? d1 : d2;
  if (lone == left) return lone > 0;
  if (lone == right) return lone < 0;
  const float s = b[0] + (b[3] - b[0]) * lone / (lone - left), t = b[1] + (b[6] - b[3]) * lone / (lone - right);
  if (s > t) {
    if (s - t > fmaxf(a[0], a[3])) return false;
    return t > a[1];
  }
  return s < a[0] || t > 0.5f * (a[3] + a[6]);
}
