// SPDX-License-Identifier: Apache-2.0
// A pair: two triangles with 18 coordinates, all float32 (72 bytes) or all double (144 bytes). The stored bits are the
// input; nothing rounds them again.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "core/vec3.h"

namespace graze {

// Vertices a[0..2] of the first triangle and b[0..2] of the second, in the order of the text format.
template <class Real>
struct BasicPair {
  Vec3<Real> a[3];
  Vec3<Real> b[3];
};
using Pair = BasicPair<float>;
using DoublePair = BasicPair<double>;
static_assert(sizeof(Pair) == 72 && sizeof(DoublePair) == 144);

inline constexpr int kCoordinates = 18;

// The unsigned integer type with the width of Real.
template <class Real>
using BitsOf = std::conditional_t<sizeof(Real) == sizeof(float), std::uint32_t, std::uint64_t>;

// The coordinate types that a reader accepts or a source draws.
enum class PairTypes { f32, f64, both };

// The 18 coordinates of a pair as one array: ax0 ay0 az0 ax1 … bz2.
template <class Real>
const Real* coordinates(const BasicPair<Real>& pair) {
  return &pair.a[0].x;
}
template <class Real>
Real* coordinates(BasicPair<Real>& pair) {
  return &pair.a[0].x;
}

template <class Real>
bool is_finite(const BasicPair<Real>& pair) {
  using Bits = BitsOf<Real>;
  constexpr Bits kExponent = std::is_same_v<Real, float> ? Bits{0x7f800000u} : static_cast<Bits>(0x7ff0000000000000u);
  unsigned others = 0;  // no branch per coordinate, so compilers can vectorise this
  for (int i = 0; i < kCoordinates; ++i)
    others |= unsigned{(std::bit_cast<Bits>(coordinates(pair)[i]) & kExponent) == kExponent};
  return others == 0;
}

// The pair with float32 coordinates: each is rounded to nearest, or to infinity beyond the largest float32. Never
// inlined: if one function converts a pair to floats and back to doubles, GCC 12's vectorizer (-O3) leaves the last two
// numbers unrounded.
[[gnu::noinline]] inline Pair stored_in_float32(const DoublePair& pair) {
  Pair result;
  for (int i = 0; i < kCoordinates; ++i) coordinates(result)[i] = static_cast<float>(coordinates(pair)[i]);
  return result;
}

// The same coordinates as doubles.   Exact: always.
inline DoublePair in_doubles(const Pair& pair) {
  DoublePair result;
  for (int i = 0; i < kCoordinates; ++i) coordinates(result)[i] = static_cast<double>(coordinates(pair)[i]);
  return result;
}

}  // namespace graze
