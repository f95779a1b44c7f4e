// SPDX-License-Identifier: Apache-2.0
// Three-component vectors over any scalar: float, double, rationals, multiprecision and tracing numbers.
// All arithmetic here lives in the inline namespace of its build variant; see GRAZE_FP below.
#pragma once

#ifdef __CUDACC__
#define GRAZE_HD __host__ __device__
#define GRAZE_IN_PLACE __forceinline__
#else
#define GRAZE_HD
#define GRAZE_IN_PLACE [[gnu::always_inline]]
#endif

// The namespace of all code that computes in floating point. A template compiled under two sets of floating-point flags
// is one symbol to the linker, which keeps whichever comes first: lanes built with and without contraction would
// silently become the same code. So each variant sets GRAZE_FP on the command line.
#ifndef GRAZE_FP
#define GRAZE_FP strict
#endif

namespace graze {

template <class Real>
struct Vec3 {
  Real x, y, z;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline namespace GRAZE_FP {

template <class Real>
GRAZE_HD Vec3<Real> operator+(const Vec3<Real>& u, const Vec3<Real>& v) {
  return {u.x + v.x, u.y + v.y, u.z + v.z};
}

template <class Real>
GRAZE_HD Vec3<Real> operator-(const Vec3<Real>& u, const Vec3<Real>& v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}

template <class Real>
GRAZE_HD Vec3<Real> operator*(const Vec3<Real>& v, const Real& s) {
  return {v.x * s, v.y * s, v.z * s};
}

template <class Real>
GRAZE_HD Real dot(const Vec3<Real>& u, const Vec3<Real>& v) {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}

template <class Real>
GRAZE_HD Vec3<Real> cross(const Vec3<Real>& u, const Vec3<Real>& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

template <class Real>
GRAZE_HD Real magnitude(const Real& x) {
  return x < Real(0) ? -x : x;
}

// Index of the component of v that is largest in magnitude; the first one if several are equal.
template <class Real>
GRAZE_HD int dominant_axis(const Vec3<Real>& v) {
  const Real x = magnitude(v.x), y = magnitude(v.y), z = magnitude(v.z);
  return x < y ? (y < z ? 2 : 1) : (x < z ? 2 : 0);
}

}  // namespace GRAZE_FP

// Component i of v: 0 is x, 1 is y, 2 is z.
template <class Real>
GRAZE_HD Real component(const Vec3<Real>& v, int i) {
  return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

template <class Real>
GRAZE_HD Real& component(Vec3<Real>& v, int i) {
  return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

}  // namespace graze
