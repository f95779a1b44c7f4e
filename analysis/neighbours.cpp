// SPDX-License-Identifier: Apache-2.0
#include "analysis/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "analysis/scales.h"

namespace graze::analysis {
namespace {

// The six orders of three things.
constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

// x + y if the sum is exact.   Reference: Knuth, two-sum.
template <class Real>
std::optional<Real> exact_sum(Real x, Real y) {
  const Real sum = x + y, other = sum - x, rest = (x - (sum - other)) + (y - other);
  return std::isfinite(sum) && rest == 0 ? std::optional(sum) : std::nullopt;
}

// (x + y) / 2 if that is exact.
template <class Real>
std::optional<Real> exact_middle(Real x, Real y) {
  if (const std::optional<Real> sum = exact_sum(x, y))
    return *sum / 2 * 2 == *sum ? std::optional(*sum / 2) : std::nullopt;
  return x / 2 * 2 == x && y / 2 * 2 == y ? exact_sum(x / 2, y / 2) : std::nullopt;  // x + y may overflow
}

template <class Real>
Real largest_of(const BasicPair<Real>& pair) {
  Real largest = 0;
  for (int i = 0; i < kCoordinates; ++i) largest = std::max(largest, std::abs(coordinates(pair)[i]));
  return largest;
}

template <class Real>
std::optional<BasicPair<Real>> moved_by(const BasicPair<Real>& pair, const Vec3<Real>& step) {
  BasicPair<Real> moved;
  for (int i = 0; i < kCoordinates; ++i) {
    const std::optional<Real> sum = exact_sum(coordinates(pair)[i], component(step, i % 3));
    if (!sum) return {};
    coordinates(moved)[i] = *sum;
  }
  return moved;
}

// The midpoints of the edges from v[0] to v[1], from v[1] to v[2] and from v[2] to v[0], if they are exact.
template <class Real>
bool exact_middles(const Vec3<Real> (&v)[3], Vec3<Real> (&middles)[3]) {
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<Real> middle = exact_middle(component(v[i], axis), component(v[(i + 1) % 3], axis));
      if (!middle) return false;
      component(middles[i], axis) = *middle;
    }
  }
  return true;
}

}  // namespace

template <class Real>
std::vector<BasicPair<Real>> orders(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result;
  for (int order = 0; order < 72; ++order) {
    BasicPair<Real> reordered;
    for (int i = 0; i < 3; ++i) {
      reordered.a[i] = pair.a[kOrders[order % 6][i]];
      reordered.b[i] = pair.b[kOrders[order / 6 % 6][i]];
    }
    if (order >= 36) std::swap(reordered.a, reordered.b);
    result.push_back(reordered);
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> mirrored(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result(8, pair);
  for (int way = 0; way < 8; ++way) {
    Real* c = coordinates(result[static_cast<std::size_t>(way)]);
    for (int i = 0; i < kCoordinates; ++i) c[i] = way >> i % 3 & 1 ? -c[i] : c[i];
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> scalings(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result{pair};
  for (int k = -kMostScaling; k <= kMostScaling; ++k) {
    if (k == 0) continue;
    if (const std::optional<BasicPair<Real>> image = exactly_scaled(pair, k)) result.push_back(*image);
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> axes(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result;
  for (const auto& order : kOrders) {
    BasicPair<Real> turned;
    for (int i = 0; i < kCoordinates; ++i) coordinates(turned)[i] = coordinates(pair)[i - i % 3 + order[i % 3]];
    result.push_back(turned);
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> translated(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result{pair};
  const Real largest = largest_of(pair);
  std::vector<Vec3<Real>> steps;
  for (const auto& triangle : {pair.a, pair.b}) {
    for (int i = 0; i < 3; ++i) steps.push_back({-triangle[i].x, -triangle[i].y, -triangle[i].z});
  }
  if (largest > 0) {
    const Real step = std::ldexp(Real{1}, std::ilogb(largest));
    steps.push_back({step, step, step});
    steps.push_back({-step, -step, -step});
  }
  for (const Vec3<Real>& step : steps) {
    if (const std::optional<BasicPair<Real>> moved = moved_by(pair, step)) result.push_back(*moved);
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> parts(const BasicPair<Real>& pair) {
  std::vector<BasicPair<Real>> result{pair};
  for (const bool first : {true, false}) {
    const auto& whole = first ? pair.a : pair.b;
    Vec3<Real> m[3];
    if (!exact_middles(whole, m)) continue;
    const Vec3<Real> divided[4][3] = {
        {whole[0], m[0], m[2]}, {m[0], whole[1], m[1]}, {m[2], m[1], whole[2]}, {m[0], m[1], m[2]}};
    for (const auto& part : divided) {
      BasicPair<Real> with = pair;
      std::copy(part, part + 3, first ? with.a : with.b);
      result.push_back(with);
    }
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> nudged(const BasicPair<Real>& pair, int coordinate) {
  const Real c = coordinates(pair)[coordinate], size = c == 0 ? largest_of(pair) : std::abs(c);
  const Real ulp = std::nextafter(size, std::numeric_limits<Real>::infinity()) - size, more = size * Real{0x1p-10};
  std::vector<BasicPair<Real>> result;
  for (const Real step : {ulp, -ulp, more, -more}) {
    BasicPair<Real> moved = pair;
    coordinates(moved)[coordinate] = c + step;
    if (std::isfinite(c + step) && c + step != c) result.push_back(moved);
  }
  return result;
}

template std::vector<Pair> orders(const Pair&);
template std::vector<DoublePair> orders(const DoublePair&);
template std::vector<Pair> mirrored(const Pair&);
template std::vector<DoublePair> mirrored(const DoublePair&);
template std::vector<Pair> scalings(const Pair&);
template std::vector<DoublePair> scalings(const DoublePair&);
template std::vector<Pair> axes(const Pair&);
template std::vector<DoublePair> axes(const DoublePair&);
template std::vector<Pair> translated(const Pair&);
template std::vector<DoublePair> translated(const DoublePair&);
template std::vector<Pair> parts(const Pair&);
template std::vector<DoublePair> parts(const DoublePair&);
template std::vector<Pair> nudged(const Pair&, int);
template std::vector<DoublePair> nudged(const DoublePair&, int);

}  // namespace graze::analysis
