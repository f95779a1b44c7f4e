// SPDX-License-Identifier: Apache-2.0
// A test of separating axes, with loops over edges that the compiler unrolls.
__device__ bool separated(const float axis[3], const float a[9], const float b[9]) {
  float a_min = 1e30f, a_max = -1e30f, b_min = 1e30f, b_max = -1e30f;
  for (int v = 0; v < 3; ++v) {
    float p = 0, q = 0;
    for (int k = 0; k < 3; ++k) {
      p += axis[k] * a[3 * v + k];
      q += axis[k] * b[3 * v + k];
    }
    if (p < a_min) a_min = p;
    if (p > a_max) a_max = p;
    if (q < b_min) b_min = q;
    if (q > b_max) b_max = q;
  }
  return a_max < b_min || b_max < a_min;
}

__device__ bool intersects(const float a[9], const float b[9]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      float e[3], f[3];
      for (int k = 0; k < 3; ++k) {
        e[k] = a[3 * ((i + 1) % 3) + k] - a[3 * i + k];
        f[k] = b[3 * ((j + 1) % 3) + k] - b[3 * j + k];
      }
      const float axis[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
      if (separated(axis, a, b)) return false;
    }
  }
  return true;
}
