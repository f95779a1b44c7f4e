// SPDX-License-Identifier: Apache-2.0
// A predicate with differences of products (Kahan). The predicate calls fmaf, which no compiler flag replaces.
#include <cmath>

__device__ float difference(float a, float b, float c, float d) {
  const float w = b * c;
  const float error = fmaf(-b, c, w);
  return fmaf(a, d, -w) + error;
}

__device__ float volume(const float* p, const float* q, const float* r, const float* s) {
  const float ax = p[0] - s[0], ay = p[1] - s[1], az = p[2] - s[2];
  const float bx = q[0] - s[0], by = q[1] - s[1], bz = q[2] - s[2];
  const float cx = r[0] - s[0], cy = r[1] - s[1], cz = r[2] - s[2];
  return fmaf(ax, difference(by, bz, cy, cz), fmaf(ay, difference(bz, bx, cz, cx), az * difference(bx, by, cx, cy)));
}

__device__ bool intersects(const float a[9], const float b[9]) {
  const float u = volume(a, a + 3, a + 6, b), v = volume(a, a + 3, a + 6, b + 3), w = volume(a, a + 3, a + 6, b + 6);
  const float x = volume(b, b + 3, b + 6, a), y = volume(b, b + 3, b + 6, a + 3), z = volume(b, b + 3, b + 6, a + 6);
  return !(u > 0 && v > 0 && w > 0) && !(u < 0 && v < 0 && w < 0) && u * x + v * y <= w * z;
}
