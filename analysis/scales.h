// SPDX-License-Identifier: Apache-2.0
// Finds the powers of two by which a pair can be scaled so that no product of its coordinates leaves a scalar's
// exponent range.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "core/lanes/lanes.h"
#include "core/pair.h"

namespace graze::analysis {

struct ScalarLimits {
  std::string_view name;
  int digits, least,
      most;  // bits of the mantissa; exponents of the least normal number, and of the largest power of two
};

inline const ScalarLimits& limits_of(Scalar scalar) {
  static constexpr ScalarLimits kLimits[] = {{"float32", 24, -126, 127}, {"float64", 53, -1022, 1023}};
  return kLimits[static_cast<int>(scalar)];
}

// Exponent bounds of a pair: all coordinates are multiples of 2^low and less than 2^high.
struct Size {
  static constexpr int kNone = 10'000;  // beyond all exponents
  int low = kNone, high = -kNone;
  int largest_difference = -kNone, smallest_difference = kNone;  // exponents of vertex differences along one axis
  int least, most;  // exponents of the coordinate type's least number, and of the first number beyond its largest

  template <class Real>
  explicit Size(const BasicPair<Real>& pair)
      : least(std::numeric_limits<Real>::min_exponent - std::numeric_limits<Real>::digits),
        most(std::numeric_limits<Real>::max_exponent) {
    constexpr int kDigits = std::numeric_limits<Real>::digits;
    const Real* c = coordinates(pair);
    for (int i = 0; i < kCoordinates; ++i) {
      if (c[i] == 0) continue;
      int exponent;
      const auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::fabs(c[i]), &exponent), kDigits));
      high = std::max(high, exponent);
      low = std::min(low, exponent - kDigits + std::countr_zero(mantissa));
      for (int j = i % 3; j < i; j += 3) add_difference(double{c[i]} - c[j]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const bool zero = std::any_of(c, c + kCoordinates, [&](const Real& x) { return (&x - c) % 3 == axis && x == 0; });
      for (int i = axis; zero && i < kCoordinates; i += 3) add_difference(double{c[i]});
    }
  }

  bool is_zero() const { return high == -kNone; }  // whether all coordinates are zero

 private:
  void add_difference(double difference) {
    if (difference == 0) return;
    const int exponent = std::isinf(difference) ? most : std::ilogb(difference);
    largest_difference = std::max(largest_difference, exponent);
    smallest_difference = std::min(smallest_difference, exponent);
  }
};

// A range of scales 2^k, first <= k <= last.
struct Scales {
  int first, last;
  bool empty() const { return first > last; }
  bool has(int k) const { return first <= k && k <= last; }
};

inline Scales common(Scales l, Scales r) { return {std::max(l.first, r.first), std::min(l.last, r.last)}; }

// The scales at which only the exponents of the coordinates change.   Requires here and below: not is_zero().
inline Scales exact_scales(const Size& size) { return {size.least - size.low, size.most - size.high}; }

// The scales at which no product of this many coordinates, and no sum of four such products, can leave the scalar's
// exponent range. No matter how it is rounded, such a product is a multiple of 2^(factors * low), or 0.
inline Scales scales_in_range(const Size& size, Scalar scalar, int factors) {
  const ScalarLimits& limits = limits_of(scalar);
  // Both divisions round inwards.
  return common({-(-limits.least / factors) - size.low, limits.most / factors - 2 - size.high}, exact_scales(size));
}

template <class Real>
BasicPair<Real> scaled(const BasicPair<Real>& pair, int k) {
  BasicPair<Real> result = pair;
  for (int i = 0; i < kCoordinates; ++i) coordinates(result)[i] = std::ldexp(coordinates(pair)[i], k);
  return result;
}

// Scales the pair by 2^k; returns nothing if a coordinate would lose bits or overflow.
template <class Real>
std::optional<BasicPair<Real>> exactly_scaled(const BasicPair<Real>& pair, int k) {
  const BasicPair<Real> result = scaled(pair, k), back = scaled(result, -k);
  if (!std::equal(coordinates(pair), coordinates(pair) + kCoordinates, coordinates(back))) return std::nullopt;
  return result;
}

}  // namespace graze::analysis
