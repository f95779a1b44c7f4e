// SPDX-License-Identifier: Apache-2.0
// A predicate with functions that take and return structs.
struct Vector {
  float x, y, z;
};
struct Interval {
  Vector axis;
  float low, high;
  bool empty;
};

__noinline__ __device__ Vector cross(Vector u, Vector v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}
__device__ Vector vertex(const float* t, int v) { return {t[3 * v], t[3 * v + 1], t[3 * v + 2]}; }
__device__ Vector minus(Vector u, Vector v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
__device__ float dot(Vector u, Vector v) { return u.x * v.x + u.y * v.y + u.z * v.z; }

__noinline__ __device__ Interval interval(Vector axis, const float* t) {
  Interval i{axis, dot(axis, vertex(t, 0)), 0, true};
  i.high = i.low;
  for (int v = 1; v < 3; ++v) {
    const float d = dot(axis, vertex(t, v));
    i.low = d < i.low ? d : i.low;
    i.high = d > i.high ? d : i.high;
  }
  i.empty = !(i.low <= i.high);
  return i;
}

__device__ bool intersects(const float a[9], const float b[9]) {
  const Vector n = cross(minus(vertex(a, 1), vertex(a, 0)), minus(vertex(a, 2), vertex(a, 0)));
  const Vector m = cross(minus(vertex(b, 1), vertex(b, 0)), minus(vertex(b, 2), vertex(b, 0)));
  const Vector axes[3] = {n, m, cross(n, m)};
  for (const Vector& axis : axes) {
    const Interval i = interval(axis, a), j = interval(axis, b);
    if (i.empty || j.empty || i.high < j.low || j.high < i.low) return false;
  }
  return true;
}
