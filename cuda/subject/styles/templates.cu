// SPDX-License-Identifier: Apache-2.0
// A predicate with templates over the axis and the number of vertices.
template <int Axis, class Real>
__device__ Real area(const Real* p, const Real* q, const Real* r) {
  constexpr int u = (Axis + 1) % 3, v = (Axis + 2) % 3;
  return (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
}

template <int Axis, int Count, class Real>
__device__ int sides(const Real* p, const Real* q, const Real* others) {
  if constexpr (Count == 0) {
    return 0;
  } else {
    const Real d = area<Axis>(p, q, others);
    return (d > 0 ? 1 : d < 0 ? 2 : 3) | sides<Axis, Count - 1>(p, q, others + 3);
  }
}

template <int Axis, class Real>
__device__ bool overlap(const Real* a, const Real* b) {
  for (int e = 0; e < 3; ++e) {
    const int others = sides<Axis, 3>(a + 3 * e, a + 3 * ((e + 1) % 3), b);
    const int own = sides<Axis, 1>(a + 3 * e, a + 3 * ((e + 1) % 3), a + 3 * ((e + 2) % 3));
    if ((others | own) == 3 && others != 3 && own != 3) return false;
  }
  return true;
}

__device__ bool intersects(const float a[9], const float b[9]) {
  return overlap<0>(a, b) && overlap<1>(b, a) && overlap<2>(a, b) && overlap<0>(b, a);
}
