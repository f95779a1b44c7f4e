// SPDX-License-Identifier: Apache-2.0
#include "analysis/neighbours.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace graze::analysis {

std::vector<Pair> orders(const Pair& pair) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  std::vector<Pair> result;
  for (int order = 0; order < 72; ++order) {
    Pair reordered;
    for (int i = 0; i < 3; ++i) {
      reordered.a[i] = pair.a[kOrders[order % 6][i]];
      reordered.b[i] = pair.b[kOrders[order / 6 % 6][i]];
    }
    if (order >= 36) std::swap(reordered.a, reordered.b);
    result.push_back(reordered);
  }
  return result;
}

std::vector<Pair> mirrored(const Pair& pair) {
  std::vector<Pair> result(8, pair);
  for (int way = 0; way < 8; ++way) {
    float* c = coordinates(result[static_cast<std::size_t>(way)]);
    for (int i = 0; i < kCoordinates; ++i) c[i] = way >> i % 3 & 1 ? -c[i] : c[i];
  }
  return result;
}

std::vector<Pair> scalings(const Pair& pair) {
  std::vector<Pair> result{pair};
  for (int k = -kMostScaling; k <= kMostScaling; ++k) {
    Pair scaled;
    bool exact = k != 0;
    for (int i = 0; i < kCoordinates; ++i) {
      const float c = coordinates(pair)[i];
      coordinates(scaled)[i] = std::ldexp(c, k);
      exact = exact && std::ldexp(coordinates(scaled)[i], -k) == c;
    }
    if (exact) result.push_back(scaled);
  }
  return result;
}

std::vector<Pair> nudged(const Pair& pair, int coordinate) {
  float largest = 0;
  for (int i = 0; i < kCoordinates; ++i) largest = std::max(largest, std::abs(coordinates(pair)[i]));
  const float c = coordinates(pair)[coordinate], size = c == 0 ? largest : std::abs(c);
  const float ulp = std::nextafter(size, INFINITY) - size, more = size * 0x1p-10f;
  std::vector<Pair> result;
  for (const float step : {ulp, -ulp, more, -more}) {
    Pair moved = pair;
    coordinates(moved)[coordinate] = c + step;
    if (std::isfinite(c + step) && c + step != c) result.push_back(moved);
  }
  return result;
}

}  // namespace graze::analysis
