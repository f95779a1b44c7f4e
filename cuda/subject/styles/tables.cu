// SPDX-License-Identifier: Apache-2.0
// A predicate with tables of floats, integers and bytes in constant and global memory.
__constant__ unsigned char kNext[3] = {1, 2, 0};
__constant__ float kAxes[7][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}, {0.25f, -0.5f, 1}};
__device__ const short kFirst[] = {0, -3, 6};

__device__ float along(const float axis[3], const float* v) { return axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]; }

__device__ bool intersects(const float a[9], const float b[9]) {
#pragma unroll 1
  for (int x = 0; x < 7; ++x) {
    float low[2] = {3e38f, 3e38f}, high[2] = {-3e38f, -3e38f};
#pragma unroll 1
    for (int v = 0; v < 3; ++v) {
      const int at = kFirst[v] < 0 ? -kFirst[v] : kFirst[v];
      const float p = along(kAxes[x], a + at), q = along(kAxes[x], b + 3 * kNext[v]);
      low[0] = p < low[0] ? p : low[0];
      high[0] = p > high[0] ? p : high[0];
      low[1] = q < low[1] ? q : low[1];
      high[1] = q > high[1] ? q : high[1];
    }
    if (high[0] < low[1] || high[1] < low[0]) return false;
  }
  return true;
}
