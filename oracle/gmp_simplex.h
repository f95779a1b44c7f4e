// SPDX-License-Identifier: Apache-2.0
// Vectors of GMP integers in registers that are never freed, and the simplices that gmp_contact.cpp compares.
#pragma once

#include <gmp.h>

namespace graze::gmp {

// A GMP integer that lives as long as its thread, so that nothing is allocated in the steady state.
struct Register {
  mpz_t value;
  Register() { mpz_init2(value, 1024); }
  ~Register() { mpz_clear(value); }
  Register(const Register&) = delete;
  Register& operator=(const Register&) = delete;
  operator mpz_ptr() { return value; }
  operator mpz_srcptr() const { return value; }
  int sign() const { return mpz_sgn(value); }
};

struct Point {
  Register c[3];
};

inline void subtract(Point& out, const Point& p, const Point& q) {
  for (int i = 0; i < 3; ++i) mpz_sub(out.c[i], p.c[i], q.c[i]);
}

inline void cross(Point& out, const Point& u, const Point& v) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    mpz_mul(out.c[i], u.c[j], v.c[k]);
    mpz_submul(out.c[i], u.c[k], v.c[j]);
  }
}

inline void dot(Register& out, const Point& u, const Point& v) {
  mpz_mul(out, u.c[0], v.c[0]);
  mpz_addmul(out, u.c[1], v.c[1]);
  mpz_addmul(out, u.c[2], v.c[2]);
}

inline bool is_zero(const Point& v) { return v.c[0].sign() == 0 && v.c[1].sign() == 0 && v.c[2].sign() == 0; }

// Lexicographic order: -1, 0 or 1.
inline int compare(const Point& p, const Point& q) {
  for (int i = 0; i < 3; ++i) {
    if (const int order = mpz_cmp(p.c[i], q.c[i])) return order < 0 ? -1 : 1;
  }
  return 0;
}

// The convex hull of a triangle's vertices: `count` affinely independent points, and its edges between them.
// Edge i runs from vertex[i] to vertex[(i + 1) % 3].
struct Simplex {
  const Point* vertex[3];
  int count;
  int edges() const { return count == 3 ? 3 : count - 1; }
  const Point& from(int edge) const { return *vertex[edge]; }
  const Point& to(int edge) const { return *vertex[(edge + 1) % 3]; }
};

// The flat triangle's simplex: its two extreme points, or one.
inline Simplex flat_simplex(const Point (&p)[3]) {
  int low = 0, high = 0;
  for (int i = 1; i < 3; ++i) {
    if (compare(p[i], p[low]) < 0) low = i;
    if (compare(p[i], p[high]) > 0) high = i;
  }
  if (low == high) return {{&p[0], nullptr, nullptr}, 1};
  return {{&p[low], &p[high], nullptr}, 2};
}

// Where a point of a triangle's plane lies, from its signed sides of the three edges of that triangle.
enum class Place { outside, face, edge, vertex };
struct Location {
  Place place;
  int edge;  // when place == edge
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
