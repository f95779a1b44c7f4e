// SPDX-License-Identifier: Apache-2.0
// A predicate with loops that the compiler does not unroll, over local arrays whose indices are known only at run time.
__device__ bool intersects(const float a[9], const float b[9]) {
  float edges[18];
#pragma unroll 1
  for (int i = 0; i < 9; ++i) {
    edges[i] = a[(i + 3) % 9] - a[i];
    edges[9 + i] = b[(i + 3) % 9] - b[i];
  }
  unsigned seen = 0;
#pragma unroll 1
  for (int t = 0; t < 2; ++t) {
    const float* e = edges + 9 * t;
    const float* own = t ? b : a;
    const float* other = t ? a : b;
    float n[3];
#pragma unroll 1
    for (int k = 0; k < 3; ++k) n[k] = e[(k + 1) % 3] * e[3 + (k + 2) % 3] - e[(k + 2) % 3] * e[3 + (k + 1) % 3];
#pragma unroll 1
    for (int v = 0; v < 3; ++v) {
      float d = 0;
#pragma unroll 1
      for (int k = 0; k < 3; ++k) d += n[k] * (other[3 * v + k] - own[k]);
      seen |= (d > 0 ? 1u : d < 0 ? 2u : 3u) << (4 * t);
    }
  }
  return (seen & 3) == 3 && (seen >> 4 & 3) == 3;
}
