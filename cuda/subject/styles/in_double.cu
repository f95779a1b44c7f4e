// SPDX-License-Identifier: Apache-2.0
// A predicate whose parameters and operations are in double.
__device__ double volume(const double* p, const double* q, const double* r, const double* s) {
  const double ax = p[0] - s[0], ay = p[1] - s[1], az = p[2] - s[2];
  const double bx = q[0] - s[0], by = q[1] - s[1], bz = q[2] - s[2];
  const double cx = r[0] - s[0], cy = r[1] - s[1], cz = r[2] - s[2];
  return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx);
}

__device__ int intersects(const double a[9], const double b[9]) {
  for (int t = 0; t < 2; ++t) {
    const double *p = t ? b : a, *q = t ? a : b;
    const double u = volume(p, p + 3, p + 6, q), v = volume(p, p + 3, p + 6, q + 3), w = volume(p, p + 3, p + 6, q + 6);
    if (u != u || v != v || w != w) return -1;
    const double scale = fmax(fmax(fabs(u), fabs(v)), fabs(w));
    if (fmin(fmin(u, v), w) > 1e-14 * scale || fmax(fmax(u, v), w) < -1e-14 * scale) return 0;
  }
  return 1;
}
