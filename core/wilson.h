// SPDX-License-Identifier: Apache-2.0
// Shares with 95 % confidence bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace graze {

struct Share {
  std::uint64_t count = 0, of = 0;
  double share = 0;          // 0 if there are no cases
  double low = 0, high = 1;  // confidence interval of the underlying rate
  bool apart(const Share& other) const { return high < other.low || other.high < low; }
};

// Reference: Wilson 1927, the score interval.
inline Share share_of(std::uint64_t count, std::uint64_t of) {
  if (of == 0) return {};
  constexpr double kZ = 1.959963984540054;  // 97.5 % of the standard normal distribution lies below
  const double n = static_cast<double>(of), p = static_cast<double>(count) / n, z2 = kZ * kZ;
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kZ / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {count, of, p, count == 0 ? 0 : std::max(0.0, middle - half), count == of ? 1 : std::min(1.0, middle + half)};
}

// Upper 95 % bound on a rate after n trials without an event: at this rate, the chance of no event is 5 %.
inline double bound_of_none(std::uint64_t n) {
  return n == 0 ? 1 : -std::expm1(std::log(0.05) / static_cast<double>(n));
}

}  // namespace graze
