// SPDX-License-Identifier: Apache-2.0
// Splits float32 bits into mantissa and exponent; see integer_pair.h.
#include "oracle/integer_pair.h"

#include <algorithm>
#include <bit>

namespace graze::oracle {
namespace {

// |value| = mantissa * 2^exponent, mantissa < 2^24; subnormals share the exponent of the smallest normals.
struct Parts {
  std::uint32_t mantissa;
  int exponent;
  bool negative;
};

Parts split(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t biased = (bits >> 23) & 0xffu;
  const std::uint32_t fraction = bits & 0x7fffffu;
  const std::uint32_t hidden = biased != 0 ? 0x800000u : 0u;
  return {fraction | hidden, static_cast<int>(std::max(biased, 1u)) - 150, (bits >> 31) != 0};
}

// mantissa * 2^shift, without losing a bit.   Requires: it fits.
std::int64_t shifted(const Parts& parts, int shift) {
  const std::int64_t size = shift >= 0 ? std::int64_t{parts.mantissa} << shift : std::int64_t{parts.mantissa} >> -shift;
  return parts.negative ? -size : size;
}

}  // namespace

Grid grid_of(const Pair& pair) {
  int lowest = 128, highest = -150;
  for (int i = 0; i < kCoordinates; ++i) {
    const Parts parts = split(coordinates(pair)[i]);
    if (parts.mantissa == 0) continue;
    lowest = std::min(lowest, parts.exponent + std::countr_zero(parts.mantissa));
    highest = std::max(highest, parts.exponent + static_cast<int>(std::bit_width(parts.mantissa)));
  }
  return highest < lowest ? Grid{} : Grid{lowest, highest - lowest};
}

SmallPair small_integers(const Pair& pair, const Grid& grid) {
  SmallPair result;
  std::int64_t* out = &result.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    const Parts parts = split(coordinates(pair)[i]);
    // A zero may have any exponent; the shifts of all others stay below kSmallBits.
    out[i] = parts.mantissa == 0 ? 0 : shifted(parts, parts.exponent - grid.exponent);
  }
  return result;
}

void set_integer(mpz_t out, float coordinate, const Grid& grid) {
  const Parts parts = split(coordinate);
  const int shift = parts.exponent - grid.exponent;
  if (parts.mantissa == 0) return mpz_set_ui(out, 0);
  if (shift < 64 - 24) return mpz_set_si(out, shifted(parts, shift));
  mpz_set_ui(out, parts.mantissa);
  mpz_mul_2exp(out, out, static_cast<mp_bitcnt_t>(shift));
  if (parts.negative) mpz_neg(out, out);
}

LargePair large_integers(const Pair& pair, const Grid& grid) {
  LargePair result;
  for (int i = 0; i < kCoordinates; ++i) {
    Vec3<mpz_class>& point = i < 9 ? result.a[i / 3] : result.b[(i - 9) / 3];
    set_integer(component(point, i % 3).get_mpz_t(), coordinates(pair)[i], grid);
  }
  return result;
}

}  // namespace graze::oracle
