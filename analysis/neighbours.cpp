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

// x + y if the sum is exact.   Reference: Knuth, two-sum.
std::optional<float> exact_sum(float x, float y) {
  const float sum = x + y, other = sum - x, rest = (x - (sum - other)) + (y - other);
  return std::isfinite(sum) && rest == 0 ? std::optional(sum) : std::nullopt;
}

// (x + y) / 2 if that is exact.
std::optional<float> exact_middle(float x, float y) {
  const double middle = (double{x} + double{y}) / 2;  // the sum is rounded if the floats are far apart
  const auto result = static_cast<float>(middle);
  const bool exact =
      double{result} == middle && middle * 2 - double{x} == double{y} && middle * 2 - double{y} == double{x};
  return exact ? std::optional(result) : std::nullopt;
}

std::optional<Pair> moved_by(const Pair& pair, const Vec3<float>& step) {
  Pair moved;
  for (int i = 0; i < kCoordinates; ++i) {
    const std::optional<float> sum = exact_sum(coordinates(pair)[i], component(step, i % 3));
    if (!sum) return {};
    coordinates(moved)[i] = *sum;
  }
  return moved;
}

// The midpoints of the edges from v[0] to v[1], from v[1] to v[2] and from v[2] to v[0], if they are exact.
bool exact_middles(const Vec3<float> (&v)[3], Vec3<float> (&middles)[3]) {
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<float> middle = exact_middle(component(v[i], axis), component(v[(i + 1) % 3], axis));
      if (!middle) return false;
      component(middles[i], axis) = *middle;
    }
  }
  return true;
}

}  // namespace

template <class Real>
std::vector<BasicPair<Real>> orders(const BasicPair<Real>& pair) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
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

std::vector<Pair> axes(const Pair& pair) {
  constexpr int kAxes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  std::vector<Pair> result;
  for (const auto& order : kAxes) {
    Pair turned;
    for (int i = 0; i < kCoordinates; ++i) coordinates(turned)[i] = coordinates(pair)[i - i % 3 + order[i % 3]];
    result.push_back(turned);
  }
  return result;
}

std::vector<Pair> translated(const Pair& pair) {
  std::vector<Pair> result{pair};
  float largest = 0;
  for (int i = 0; i < kCoordinates; ++i) largest = std::max(largest, std::abs(coordinates(pair)[i]));
  std::vector<Vec3<float>> steps;
  for (const auto& triangle : {pair.a, pair.b}) {
    for (int i = 0; i < 3; ++i) steps.push_back({-triangle[i].x, -triangle[i].y, -triangle[i].z});
  }
  if (largest > 0) {
    const float step = std::ldexp(1.0f, std::ilogb(largest));
    steps.push_back({step, step, step});
    steps.push_back({-step, -step, -step});
  }
  for (const Vec3<float>& step : steps) {
    if (const std::optional<Pair> moved = moved_by(pair, step)) result.push_back(*moved);
  }
  return result;
}

std::vector<Pair> parts(const Pair& pair) {
  std::vector<Pair> result{pair};
  for (const bool first : {true, false}) {
    const auto& whole = first ? pair.a : pair.b;
    Vec3<float> m[3];
    if (!exact_middles(whole, m)) continue;
    const Vec3<float> divided[4][3] = {
        {whole[0], m[0], m[2]}, {m[0], whole[1], m[1]}, {m[2], m[1], whole[2]}, {m[0], m[1], m[2]}};
    for (const auto& part : divided) {
      Pair with = pair;
      std::copy(part, part + 3, first ? with.a : with.b);
      result.push_back(with);
    }
  }
  return result;
}

template <class Real>
std::vector<BasicPair<Real>> nudged(const BasicPair<Real>& pair, int coordinate) {
  Real largest = 0;
  for (int i = 0; i < kCoordinates; ++i) largest = std::max(largest, std::abs(coordinates(pair)[i]));
  const Real c = coordinates(pair)[coordinate], size = c == 0 ? largest : std::abs(c);
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
template std::vector<Pair> nudged(const Pair&, int);
template std::vector<DoublePair> nudged(const DoublePair&, int);

}  // namespace graze::analysis
