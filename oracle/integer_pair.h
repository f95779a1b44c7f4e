// SPDX-License-Identifier: Apache-2.0
// A pair as integers: each coordinate is an integer times a power of two that all 18 coordinates share. The power of
// two does not affect the signs of determinants; lengths are multiplied by it at the end. Float32 pairs are widened.
#pragma once

#include <cstdint>

#include <gmpxx.h>

#include "core/pair.h"
#include "core/verdict.h"

namespace graze::oracle {

// If coordinates have at most this many bits, every degree-3 predicate fits in a signed 128-bit integer:
//   a difference                  < 2 * 2^40           = 2^41
//   a 2x2 minor                   < 2 * 2^41 * 2^41    = 2^83
//   a 3x3 determinant             < 3 * 2^83 * 2^41    < 2^126
//   such a determinant with one row of sums of two differences, as in CGAL's line-line test:  < 3 * 2^83 * 2^42 < 2^127
inline constexpr int kSmallBits = 40;

// The common grid: every coordinate is an integer of at most `bits` bits times 2^exponent.
struct Grid {
  int exponent = 0;  // float32: in [-149, 127]; double: in [-1074, 1023]; 0 when all coordinates are zero
  int bits = 0;      // float32: in [0, 277]; double: in [0, 2098]
  bool is_small() const { return bits <= kSmallBits; }
};

// Requires: finite coordinates.   Returns: the coarsest such grid.
Grid grid_of(const DoublePair& pair);
inline Grid grid_of(const Pair& pair) { return grid_of(in_doubles(pair)); }

using SmallPair = BasicPair<std::int64_t>;
using WidePair = BasicPair<__int128>;  // at most kSmallBits bits, so that products of three differences fit
using LargePair = BasicPair<mpz_class>;

// The pair's coordinates divided by 2^grid.exponent.
// Requires: grid is grid_of(pair), and is_small().   Exact: always.
SmallPair small_integers(const DoublePair& pair, const Grid& grid);
inline SmallPair small_integers(const Pair& pair, const Grid& grid) { return small_integers(in_doubles(pair), grid); }

inline WidePair widened(const SmallPair& small) {
  WidePair wide;
  for (int i = 0; i < kCoordinates; ++i) coordinates(wide)[i] = coordinates(small)[i];
  return wide;
}

// Like small_integers, but for one coordinate of any size. Stores the result in an initialised GMP integer.
// Requires: grid is the grid of the coordinate's pair.   Exact: always.
void set_integer(mpz_t out, double coordinate, const Grid& grid);

// The pair's coordinates divided by 2^grid.exponent.
LargePair large_integers(const DoublePair& pair, const Grid& grid);
inline LargePair large_integers(const Pair& pair, const Grid& grid) { return large_integers(in_doubles(pair), grid); }

template <class Number>
bool is_zero(const Vec3<Number>& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

// The two decisions of truth.h, and the hulls, for a pair with integer coordinates of any size.   Exact: always.
Verdict cgal_verdict(const LargePair& pair);
Contact gmp_contact(const LargePair& pair);
Hulls hulls(const LargePair& pair);

}  // namespace graze::oracle
