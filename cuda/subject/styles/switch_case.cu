// SPDX-License-Identifier: Apache-2.0
// A predicate with a switch of many cases. The nearest pair of vertices selects the case.
__device__ bool intersects(const float a[9], const float b[9]) {
  int nearest = 0;
  float least = 3e38f;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const float x = a[3 * i] - b[3 * j], y = a[3 * i + 1] - b[3 * j + 1], z = a[3 * i + 2] - b[3 * j + 2];
      const float d = x * x + y * y + z * z;
      if (d < least) {
        least = d;
        nearest = 3 * i + j;
      }
    }
  }
  switch (nearest) {
    case 0:
      return a[0] * b[4] - a[1] * b[3] < least;
    case 1:
      return a[1] * b[5] + a[2] * b[4] > least;
    case 2:
      return a[3] / (b[6] + 2) > least;
    case 3:
      return a[4] * b[7] * a[0] > least;
    case 4:
      return a[5] - b[8] * b[8] > least;
    case 5:
      return sqrtf(fabsf(a[6])) + b[0] * b[1] > least;
    case 6:
      return a[7] > b[1] * least;
    case 7:
      return a[8] * a[8] - b[2] * b[2] > least;
    default:
      return least == 0;
  }
}
