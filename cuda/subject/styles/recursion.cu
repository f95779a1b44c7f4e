// SPDX-License-Identifier: Apache-2.0
// A recursive predicate: it halves the first triangle to a given depth, except parts far from a vertex of the second.
struct Triangle {
  float v[9];
};

__noinline__ __device__ int near(const Triangle& t, const float* p, int depth) {
  const float x = (t.v[0] + t.v[3] + t.v[6]) / 3 - p[0], y = (t.v[1] + t.v[4] + t.v[7]) / 3 - p[1],
              z = (t.v[2] + t.v[5] + t.v[8]) / 3 - p[2];
  const float e = t.v[3] - t.v[0], f = t.v[4] - t.v[1], g = t.v[5] - t.v[2];
  const float away = x * x + y * y + z * z, size = e * e + f * f + g * g;
  if (away > size) return 0;
  if (depth == 0) return 1;
  Triangle one = t, two = t;
  for (int k = 0; k < 3; ++k) one.v[3 + k] = two.v[k] = 0.5f * (t.v[k] + t.v[3 + k]);
  return near(one, p, depth - 1) + near(two, p, depth - 1);
}

__device__ bool intersects(const float a[9], const float b[9]) {
  Triangle t;
  for (int i = 0; i < 9; ++i) t.v[i] = a[i];
  return near(t, b, 3) + near(t, b + 3, 3) > near(t, b + 6, 4);
}
