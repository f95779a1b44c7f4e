// SPDX-License-Identifier: Apache-2.0
// A predicate on unit normals and distances, with square roots and divisions.
__device__ void normal(const float* t, float n[3]) {
  const float e[3] = {t[3] - t[0], t[4] - t[1], t[5] - t[2]}, f[3] = {t[6] - t[0], t[7] - t[1], t[8] - t[2]};
  n[0] = e[1] * f[2] - e[2] * f[1];
  n[1] = e[2] * f[0] - e[0] * f[2];
  n[2] = e[0] * f[1] - e[1] * f[0];
  const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int k = 0; k < 3; ++k) n[k] /= length;
}

__device__ bool intersects(const float a[9], const float b[9]) {
  float n[3], low = 3e38f, high = -3e38f;
  for (int t = 0; t < 2; ++t) {
    normal(t ? b : a, n);
    for (int v = 0; v < 9; v += 3) {
      const float* p = (t ? a : b) + v;
      const float* o = t ? b : a;
      const float d = n[0] * (p[0] - o[0]) + n[1] * (p[1] - o[1]) + n[2] * (p[2] - o[2]);
      low = fminf(low, d);
      high = fmaxf(high, d);
    }
    if (low > 1e-6f || high < -1e-6f) return false;
  }
  return low <= high;
}
