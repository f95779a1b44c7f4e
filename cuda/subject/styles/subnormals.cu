// SPDX-License-Identifier: Apache-2.0
// A predicate whose result depends on products that may be subnormal, which -ftz=true flushes to zero.
__device__ float area(const float* p, const float* q, const float* r) {
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

__device__ bool intersects(const float a[9], const float b[9]) {
  const float tiny = 0x1p-100f, small = 0x1p-30f;
  int left = 0, right = 0;
  for (int i = 0; i < 9; i += 3) {
    for (int j = 0; j < 9; j += 3) {
      const float d = area(a + i, a + (i + 3) % 9, b + j) * tiny * small;
      left += d > 0.0f;
      right += d < 0.0f;
      const float root = sqrtf(fabsf(d)) * (d / 3.0f + a[i] * small * tiny);
      left += root + d == 0.0f;
    }
  }
  return left > 4 || right < 4;
}
