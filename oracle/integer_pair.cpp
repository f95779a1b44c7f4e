// SPDX-License-Identifier: Apache-2.0
// Splits the bits of a double into mantissa and exponent; see integer_pair.h.
#include "oracle/integer_pair.h"

#include <algorithm>
#include <bit>

namespace graze::oracle {
namespace {

// |value| = mantissa * 2^exponent, mantissa < 2^53; subnormals share the exponent of the smallest normals.
struct Parts {
  std::uint64_t mantissa;
  int exponent;
  bool negative;
};

Parts split(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t biased = (bits >> 52) & 0x7ffu;
  const std::uint64_t fraction = bits & 0xfffffffffffffu;
  const std::uint64_t hidden = biased != 0 ? 0x10000000000000u : 0u;
  return {fraction | hidden, static_cast<int>(std::max<std::uint64_t>(biased, 1)) - 1075, (bits >> 63) != 0};
}

// mantissa * 2^shift.   Requires: the shift loses no bits, and the result fits.
std::int64_t shifted(const Parts& parts, int shift) {
  const auto whole = static_cast<std::int64_t>(parts.mantissa);
  const std::int64_t size = shift >= 0 ? whole << shift : whole >> -shift;
  return parts.negative ? -size : size;
}

}  // namespace

Grid grid_of(const DoublePair& pair) {
  int lowest = 1 << 11, highest = -(1 << 11);
  for (int i = 0; i < kCoordinates; ++i) {
    const Parts parts = split(coordinates(pair)[i]);
    if (parts.mantissa == 0) continue;
    lowest = std::min(lowest, parts.exponent + std::countr_zero(parts.mantissa));
    highest = std::max(highest, parts.exponent + static_cast<int>(std::bit_width(parts.mantissa)));
  }
  return highest < lowest ? Grid{} : Grid{lowest, highest - lowest};
}

SmallPair small_integers(const DoublePair& pair, const Grid& grid) {
  SmallPair result;
  std::int64_t* out = &result.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    const Parts parts = split(coordinates(pair)[i]);
    // A zero may have any exponent, so it is not shifted. All other shifts are below kSmallBits.
    out[i] = parts.mantissa == 0 ? 0 : shifted(parts, parts.exponent - grid.exponent);
  }
  return result;
}

void set_integer(mpz_t out, double coordinate, const Grid& grid) {
  const Parts parts = split(coordinate);
  const int shift = parts.exponent - grid.exponent;
  if (parts.mantissa == 0) return mpz_set_ui(out, 0);
  if (shift < 63 - 53) return mpz_set_si(out, shifted(parts, shift));  // a mantissa has 53 bits
  mpz_set_ui(out, parts.mantissa);
  mpz_mul_2exp(out, out, static_cast<mp_bitcnt_t>(shift));
  if (parts.negative) mpz_neg(out, out);
}

LargePair large_integers(const DoublePair& pair, const Grid& grid) {
  LargePair result;
  for (int i = 0; i < kCoordinates; ++i) {
    Vec3<mpz_class>& point = i < 9 ? result.a[i / 3] : result.b[(i - 9) / 3];
    set_integer(component(point, i % 3).get_mpz_t(), coordinates(pair)[i], grid);
  }
  return result;
}

}  // namespace graze::oracle
