// SPDX-License-Identifier: Apache-2.0
// Makes a pair from a fuzz input's bytes.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/pair.h"

namespace graze {

// If the first byte is even, the next 72 or 144 bytes are the coordinates' bits. If the first byte is odd, the second
// byte (times 8 for doubles) is an exponent e; 2^e times each of the next 18 bytes is a coordinate, so contacts are
// common. For doubles, each of 18 more bytes moves a nonzero coordinate by that many ulps. Missing bytes are zeros.
template <class Real = float>
BasicPair<Real> pair_of(std::string_view bytes) {
  constexpr bool kDoubles = sizeof(Real) == sizeof(double);
  unsigned char all[1 + sizeof(BasicPair<Real>)] = {};
  std::copy_n(bytes.begin(), std::min(bytes.size(), sizeof all), all);
  BasicPair<Real> pair;
  std::memcpy(&pair, all + 1, sizeof pair);
  if (all[0] % 2 == 0) return pair;
  const int exponent = static_cast<signed char>(all[1]) * (kDoubles ? 8 : 1);
  for (int i = 0; i < kCoordinates; ++i) {
    Real& x = coordinates(pair)[i];
    x = std::ldexp(static_cast<Real>(static_cast<signed char>(all[i + 2])), exponent);
    if constexpr (kDoubles) {
      const auto ulps = static_cast<std::uint64_t>(std::int64_t{static_cast<signed char>(all[i + 20])});
      if (x != 0) x = std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) + ulps);
    }
  }
  return pair;
}

// Like pair_of, but makes every coordinate finite: it lowers the exponent of an infinity or NaN by 1.
template <class Real = float>
BasicPair<Real> finite_pair_of(std::string_view bytes) {
  using Bits = BitsOf<Real>;
  BasicPair<Real> pair = pair_of<Real>(bytes);
  for (int i = 0; i < kCoordinates; ++i) {
    Real& x = coordinates(pair)[i];
    constexpr Bits kLeastOfExponent = Bits{1} << (std::numeric_limits<Real>::digits - 1);
    if (!std::isfinite(x)) x = std::bit_cast<Real>(std::bit_cast<Bits>(x) ^ kLeastOfExponent);
  }
  return pair;
}

}  // namespace graze
