// SPDX-License-Identifier: Apache-2.0
// A separating-axes test with an absolute epsilon, for tests that compare and tune code. They set its value.
static const float kEps = EPSILON;
#include <algorithm>
struct Vec {
  float x, y, z;
};
static Vec operator-(Vec p, Vec q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
static float dot(Vec p, Vec q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
static Vec cross(Vec p, Vec q) { return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}; }
static bool separates(Vec n, const Vec* a, const Vec* b) {
  const auto [a0, a1] = std::minmax({dot(n, a[0]), dot(n, a[1]), dot(n, a[2])});
  const auto [b0, b1] = std::minmax({dot(n, b[0]), dot(n, b[1]), dot(n, b[2])});
  return b0 > a1 + kEps || a0 > b1 + kEps;
}
extern "C" int intersects(const float* p, const float* q) {
  const Vec a[] = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}};
  const Vec b[] = {{q[0], q[1], q[2]}, {q[3], q[4], q[5]}, {q[6], q[7], q[8]}};
  const Vec e[] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]}, f[] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  if (separates(cross(e[0], e[1]), a, b) || separates(cross(f[0], f[1]), a, b)) return 0;
  for (int i = 0; i < 9; ++i)
    if (separates(cross(e[i / 3], f[i % 3]), a, b)) return 0;
  return 1;
}
