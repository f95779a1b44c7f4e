// SPDX-License-Identifier: Apache-2.0
// A predicate with helper functions that are not inlined and take pointers and values.
__noinline__ __device__ float orient(const float* p, const float* q, const float* r, const float* s) {
  const float ax = p[0] - s[0], ay = p[1] - s[1], az = p[2] - s[2];
  const float bx = q[0] - s[0], by = q[1] - s[1], bz = q[2] - s[2];
  const float cx = r[0] - s[0], cy = r[1] - s[1], cz = r[2] - s[2];
  return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
}

__noinline__ __device__ bool crosses(const float* t, const float* p, const float* q) {
  const float d = orient(t, t + 3, t + 6, p), e = orient(t, t + 3, t + 6, q);
  if (d * e > 0) return false;
  const float u = orient(p, q, t, t + 3), v = orient(p, q, t + 3, t + 6), w = orient(p, q, t + 6, t);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

__device__ bool intersects(const float a[9], const float b[9]) {
  return crosses(a, b, b + 3) || crosses(a, b + 3, b + 6) || crosses(a, b + 6, b) || crosses(b, a, a + 3) ||
         crosses(b, a + 3, a + 6) || crosses(b, a + 6, a);
}
