// SPDX-License-Identifier: Apache-2.0
// A predicate that tests edges against the other triangle (Moller-Trumbore) and computes 1/x once for each edge.
__device__ bool hits(const float* o, const float* end, const float* t) {
  const float d[3] = {end[0] - o[0], end[1] - o[1], end[2] - o[2]};
  const float e[3] = {t[3] - t[0], t[4] - t[1], t[5] - t[2]}, f[3] = {t[6] - t[0], t[7] - t[1], t[8] - t[2]};
  const float p[3] = {d[1] * f[2] - d[2] * f[1], d[2] * f[0] - d[0] * f[2], d[0] * f[1] - d[1] * f[0]};
  const float det = e[0] * p[0] + e[1] * p[1] + e[2] * p[2];
  if (det > -1e-8f && det < 1e-8f) return false;
  const float inverse = 1 / det;
  const float s[3] = {o[0] - t[0], o[1] - t[1], o[2] - t[2]};
  const float u = inverse * (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]);
  if (u < 0 || u > 1) return false;
  const float q[3] = {s[1] * e[2] - s[2] * e[1], s[2] * e[0] - s[0] * e[2], s[0] * e[1] - s[1] * e[0]};
  const float v = inverse * (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]);
  if (v < 0 || u + v > 1) return false;
  const float at = inverse * (f[0] * q[0] + f[1] * q[1] + f[2] * q[2]);
  return at >= 0 && at <= 1;
}

__device__ bool intersects(const float a[9], const float b[9]) {
  return hits(a, a + 3, b) || hits(a + 3, a + 6, b) || hits(a + 6, a, b) || hits(b, b + 3, a) ||
         hits(b + 3, b + 6, a) || hits(b + 6, b, a);
}
