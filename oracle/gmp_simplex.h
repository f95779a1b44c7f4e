// SPDX-License-Identifier: Apache-2.0
// Vectors of GMP integers whose memory is reused, and simplices, for gmp_contact.cpp. The integers can have any size
// (Register) or exactly two limbs (TwoLimbs).
#pragma once

#include <gmp.h>

#include <cstdint>
#include <utility>

namespace graze::gmp {

// A GMP integer that lives as long as its thread, so that it allocates memory only when it grows.
struct Register {
  mpz_t value;
  Register() { mpz_init2(value, 1024); }
  ~Register() { mpz_clear(value); }
  Register(const Register&) = delete;
  Register& operator=(const Register&) = delete;
  int sign() const { return mpz_sgn(value); }
};

inline void sub(Register& out, const Register& p, const Register& q) { mpz_sub(out.value, p.value, q.value); }
inline void add(Register& out, const Register& p, const Register& q) { mpz_add(out.value, p.value, q.value); }
inline void mul(Register& out, const Register& p, const Register& q) { mpz_mul(out.value, p.value, q.value); }
inline void add_mul(Register& out, const Register& p, const Register& q) { mpz_addmul(out.value, p.value, q.value); }
inline void sub_mul(Register& out, const Register& p, const Register& q) { mpz_submul(out.value, p.value, q.value); }
inline int compare(const Register& p, const Register& q) { return mpz_cmp(p.value, q.value); }
inline void exchange(Register& p, Register& q) { mpz_swap(p.value, q.value); }

// An integer modulo 2^128, in [-2^127, 2^127). Operations use GMP's limb functions, which do not branch on signs.
struct TwoLimbs {
  mp_limb_t limb[2];
  int sign() const { return limb[1] >> 63 ? -1 : (limb[0] | limb[1]) != 0; }
};
static_assert(GMP_NUMB_BITS == 64);

inline void set(TwoLimbs& out, std::int64_t value) {
  out = {static_cast<mp_limb_t>(value), static_cast<mp_limb_t>(value >> 63)};
}
inline void sub(TwoLimbs& out, const TwoLimbs& p, const TwoLimbs& q) { mpn_sub_n(out.limb, p.limb, q.limb, 2); }
inline void add(TwoLimbs& out, const TwoLimbs& p, const TwoLimbs& q) { mpn_add_n(out.limb, p.limb, q.limb, 2); }
inline void mul(TwoLimbs& out, const TwoLimbs& p, const TwoLimbs& q) {
  mpn_mul_1(out.limb, p.limb, 2, q.limb[0]);
  out.limb[1] += p.limb[0] * q.limb[1];
}
inline void add_mul(TwoLimbs& out, const TwoLimbs& p, const TwoLimbs& q) {
  mpn_addmul_1(out.limb, p.limb, 2, q.limb[0]);
  out.limb[1] += p.limb[0] * q.limb[1];
}
inline void sub_mul(TwoLimbs& out, const TwoLimbs& p, const TwoLimbs& q) {
  mpn_submul_1(out.limb, p.limb, 2, q.limb[0]);
  out.limb[1] -= p.limb[0] * q.limb[1];
}
inline int compare(const TwoLimbs& p, const TwoLimbs& q) {
  const auto high_p = static_cast<std::int64_t>(p.limb[1]), high_q = static_cast<std::int64_t>(q.limb[1]);
  if (high_p != high_q) return high_p < high_q ? -1 : 1;
  return p.limb[0] < q.limb[0] ? -1 : p.limb[0] != q.limb[0];
}
inline void exchange(TwoLimbs& p, TwoLimbs& q) { std::swap(p, q); }

template <class Number>
struct Point {
  Number c[3];
};

template <class Number>
void subtract(Point<Number>& out, const Point<Number>& p, const Point<Number>& q) {
  for (int i = 0; i < 3; ++i) sub(out.c[i], p.c[i], q.c[i]);
}

template <class Number>
void cross(Point<Number>& out, const Point<Number>& u, const Point<Number>& v) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    mul(out.c[i], u.c[j], v.c[k]);
    sub_mul(out.c[i], u.c[k], v.c[j]);
  }
}

template <class Number>
void dot(Number& out, const Point<Number>& u, const Point<Number>& v) {
  mul(out, u.c[0], v.c[0]);
  add_mul(out, u.c[1], v.c[1]);
  add_mul(out, u.c[2], v.c[2]);
}

template <class Number>
bool is_zero(const Point<Number>& v) {
  return v.c[0].sign() == 0 && v.c[1].sign() == 0 && v.c[2].sign() == 0;
}

// Lexicographic order: -1, 0 or 1.
template <class Number>
int compare(const Point<Number>& p, const Point<Number>& q) {
  for (int i = 0; i < 3; ++i) {
    if (const int order = compare(p.c[i], q.c[i])) return order < 0 ? -1 : 1;
  }
  return 0;
}

// The convex hull of a triangle's vertices: `count` affinely independent points, and the edges between them.
// Edge i runs from vertex[i] to vertex[(i + 1) % 3].
template <class Number>
struct Simplex {
  const Point<Number>* vertex[3];
  int count;
  int edges() const { return count == 3 ? 3 : count - 1; }
  const Point<Number>& from(int edge) const { return *vertex[edge]; }
  const Point<Number>& to(int edge) const { return *vertex[(edge + 1) % 3]; }
};

// The simplex of a flat triangle: its two extreme points, or one point.
template <class Number>
Simplex<Number> flat_simplex(const Point<Number> (&p)[3]) {
  int low = 0, high = 0;
  for (int i = 1; i < 3; ++i) {
    if (compare(p[i], p[low]) < 0) low = i;
    if (compare(p[i], p[high]) > 0) high = i;
  }
  if (low == high) return {{&p[0], nullptr, nullptr}, 1};
  return {{&p[low], &p[high], nullptr}, 2};
}

// Where a point in a triangle's plane lies, given its sides relative to the triangle's three edges.
enum class Place { outside, face, edge, vertex };
struct Location {
  Place place;
  int edge;  // valid if place == Place::edge
};

inline Location locate(const int (&side)[3]) {
  int positive = 0, negative = 0, edge = -1;
  for (int j = 0; j < 3; ++j) {
    if (side[j] > 0) ++positive;
    if (side[j] < 0) ++negative;
    if (side[j] == 0) edge = j;
  }
  if (positive != 0 && negative != 0) return {Place::outside, -1};
  const int zeros = 3 - positive - negative;
  return {zeros == 0 ? Place::face : zeros == 1 ? Place::edge : Place::vertex, edge};
}

}  // namespace graze::gmp
