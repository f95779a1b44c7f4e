// SPDX-License-Identifier: Apache-2.0
// Integers of up to 108 bits as a double and a remainder modulo 2^64. The double gives the sign unless it is small;
// then the remainder is the whole integer. This is as exact as 128-bit integers, at half the cost if doubles are fast.
//
// Coordinates have 34 bits, differences 35. A minor is less than 2^71 and its double is off by less than 2^20. A
// determinant is less than 2^108 and its double is off by less than 2^59; the difference of two is off by less than
// 2^60, in any rounding mode, with or without contraction. If a double is at most 2^61, its integer is below 2^62.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/exact/host_device.h"

namespace graze::exact::detail {

// An integer below 2^51 in magnitude.
struct Whole {
  double value;

  GRAZE_HD friend Whole operator-(Whole l, Whole r) { return {l.value - r.value}; }
  GRAZE_HD friend bool operator<(Whole l, Whole r) { return l.value < r.value; }
  GRAZE_HD friend bool operator>(Whole l, Whole r) { return l.value > r.value; }
  GRAZE_HD friend bool operator==(Whole l, Whole r) { return l.value == r.value; }

  // The last bits of x + 3 2^51 are those of x.
  GRAZE_HD std::uint64_t modulo() const {
    const double moved = value + 0x1.8p52, zero = 0x1.8p52;
    std::uint64_t bits, bits_of_zero;
    memcpy(&bits, &moved, sizeof bits);
    memcpy(&bits_of_zero, &zero, sizeof bits_of_zero);
    return bits - bits_of_zero;
  }
};

struct Residue {
  double near;
  std::uint64_t rest;

  Residue() = default;
  GRAZE_HD explicit Residue(Whole x) : near(x.value), rest(x.modulo()) {}
  GRAZE_HD explicit Residue(int x) : near(x), rest(static_cast<std::uint64_t>(std::int64_t{x})) {}
  GRAZE_HD Residue(double n, std::uint64_t r) : near(n), rest(r) {}

  GRAZE_HD friend Residue operator*(Residue l, Whole r) { return {l.near * r.value, l.rest * r.modulo()}; }
  GRAZE_HD friend Residue operator+(Residue l, Residue r) { return {l.near + r.near, l.rest + r.rest}; }
  GRAZE_HD friend Residue operator-(Residue l, Residue r) { return {l.near - r.near, l.rest - r.rest}; }

  GRAZE_HD int sign() const {
    constexpr double kSmall = 0x1p61;
    const auto all = static_cast<std::int64_t>(rest);
    return near > kSmall ? 1 : near < -kSmall ? -1 : int{all > 0} - int{all < 0};
  }
  GRAZE_HD friend bool operator<(Residue l, Residue r) { return (l - r).sign() < 0; }
  GRAZE_HD friend bool operator>(Residue l, Residue r) { return (l - r).sign() > 0; }
  GRAZE_HD friend bool operator==(Residue l, Residue r) { return (l - r).sign() == 0; }
};

// The sign of p q - r s; all four are differences. The remainder of this minor matters only if its double is small.
GRAZE_HD inline int sign_of_difference(Whole p, Whole q, Whole r, Whole s) {
  constexpr double kSmall = 0x1p21;
  const double near = p.value * q.value - r.value * s.value;
  if (near > kSmall) return 1;
  if (near < -kSmall) return -1;
  const auto all = static_cast<std::int64_t>(p.modulo() * q.modulo() - r.modulo() * s.modulo());
  return int{all > 0} - int{all < 0};
}

}  // namespace graze::exact::detail
