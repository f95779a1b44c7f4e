// SPDX-License-Identifier: Apache-2.0
// Vectors over any number type, and selection among three without indexing on a device.
#pragma once

#include "core/exact/host_device.h"

namespace graze::exact::detail {

template <class T>
struct Vec {
  T x, y, z;
};

template <class T>
GRAZE_HD Vec<T> operator-(const Vec<T>& u, const Vec<T>& v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}

// Minors and determinants, computed in a type M or T that holds them.
template <class M, class D>
GRAZE_HD Vec<M> cross(const Vec<D>& u, const Vec<D>& v) {
  return {M(u.y) * v.z - M(u.z) * v.y, M(u.z) * v.x - M(u.x) * v.z, M(u.x) * v.y - M(u.y) * v.x};
}

template <class T, class M, class D>
GRAZE_HD T dot(const Vec<M>& n, const Vec<D>& v) {
  return T(n.x) * v.x + T(n.y) * v.y + T(n.z) * v.z;
}

template <class T>
GRAZE_HD bool is_zero(const Vec<T>& v) {
  return v.x == T(0) && v.y == T(0) && v.z == T(0);
}

// Element i of three, without indexing, which on a device would move all three from registers to memory.
template <class T>
GRAZE_HD T pick(const T& x, const T& y, const T& z, unsigned i) {
  return i == 0 ? x : i == 1 ? y : z;
}

template <class D>
GRAZE_HD Vec<D> pick(const Vec<D> (&v)[3], unsigned i) {
#ifdef __CUDA_ARCH__
  return {pick(v[0].x, v[1].x, v[2].x, i), pick(v[0].y, v[1].y, v[2].y, i), pick(v[0].z, v[1].z, v[2].z, i)};
#else
  return v[i];
#endif
}

template <class Real>
GRAZE_HD Vec<Real> vertex(const Real* v, unsigned i) {
#ifdef __CUDA_ARCH__
  return {pick(v[0], v[3], v[6], i), pick(v[1], v[4], v[7], i), pick(v[2], v[5], v[8], i)};
#else
  return {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
#endif
}

template <class T>
GRAZE_HD T least(const T (&v)[3]) {
  const T& m = v[1] < v[0] ? v[1] : v[0];
  return v[2] < m ? v[2] : m;
}

template <class T>
GRAZE_HD T most(const T (&v)[3]) {
  const T& m = v[1] > v[0] ? v[1] : v[0];
  return v[2] > m ? v[2] : m;
}

}  // namespace graze::exact::detail
