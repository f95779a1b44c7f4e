// SPDX-License-Identifier: Apache-2.0
// Pairs for the oracle's tests and benchmarks, drawn by seeded generators or written by hand.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <type_traits>
#include <utility>

#include "core/pair.h"

namespace graze::oracle_test {

enum class Kind { lattice1, lattice3, uniform, near, coplanar, touching, degenerate, flat, raw_bits, wide };
inline constexpr Kind kKinds[] = {Kind::lattice1, Kind::lattice3,   Kind::uniform, Kind::near,     Kind::coplanar,
                                  Kind::touching, Kind::degenerate, Kind::flat,    Kind::raw_bits, Kind::wide};

template <class Real>
class BasicPairSource {
 public:
  BasicPairSource(Kind kind, std::uint64_t seed) : kind_(kind), random_(seed) {}

  BasicPair<Real> next() {
    BasicPair<Real> pair;
    for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = coordinate();
    if (kind_ == Kind::near || kind_ == Kind::touching) {
      // Puts b[0] on or near a point of A: its centre, the middle of an edge, or a vertex.
      const int i = below(3), j = below(2) ? (i + 1) % 3 : i, k = below(3);
      for (int axis = 0; axis < 3; ++axis) {
        const Real sum = component(pair.a[i], axis) + component(pair.a[j], axis) + component(pair.a[k], axis);
        Real at = kind_ == Kind::near ? sum / 3 : component(pair.a[i], axis);
        if (kind_ == Kind::near && below(2)) at = std::nextafter(at, below(2) ? Real(9) : Real(-9));
        component(pair.b[0], axis) = at;
      }
    }
    if (kind_ == Kind::coplanar) {
      const int axis = below(3);
      for (int i = 0; i < 3; ++i) component(pair.a[i], axis) = component(pair.b[i], axis) = Real(0.25);
      if (below(4) == 0) component(pair.a[below(3)], axis) = std::nextafter(Real(0.25), Real(1));
    }
    if (kind_ == Kind::degenerate || kind_ == Kind::flat) {
      flatten(pair.a);
      if (kind_ == Kind::flat || below(2)) flatten(pair.b);
      if (kind_ == Kind::degenerate && below(2)) std::swap(pair.a, pair.b);
    }
    return pair;
  }

  int below(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }

 private:
  static constexpr bool kIsFloat = sizeof(Real) == sizeof(float);

  Real coordinate() {
    switch (kind_) {
      case Kind::lattice1:
        return static_cast<Real>(below(3) - 1);
      case Kind::lattice3:
      case Kind::degenerate:
      case Kind::flat:
        return static_cast<Real>(below(5) - 2);
      case Kind::raw_bits:
        for (;;) {
          using Bits = std::conditional_t<kIsFloat, std::uint32_t, std::uint64_t>;
          const Real value = std::bit_cast<Real>(static_cast<Bits>(random_()));
          if (std::isfinite(value)) return value;
        }
      case Kind::wide:
        return std::ldexp(static_cast<Real>(below(5) - 2), (kIsFloat ? 30 : 250) * (below(5) - 2));
      default:
        if constexpr (kIsFloat) return static_cast<Real>(below(1 << 25) - (1 << 24)) * Real(0x1p-24f);
        return static_cast<Real>(static_cast<std::int64_t>(random_()) >> 10) * Real(0x1p-53);
    }
  }

  // Makes three points collinear or equal.
  void flatten(Vec3<Real> (&p)[3]) {
    const int to = below(3), from = (to + 1) % 3, other = (to + 2) % 3;
    const Real t = static_cast<Real>(below(4)) - 1;
    for (int axis = 0; axis < 3; ++axis) {
      const Real start = component(p[from], axis);
      component(p[to], axis) = start + t * (component(p[other], axis) - start);
    }
    if (below(6) == 0) p[0] = p[1] = p[2];
  }

  Kind kind_;
  std::mt19937_64 random_;
};
using PairSource = BasicPairSource<float>;

inline Pair pair_of(const float (&c)[kCoordinates]) {
  Pair pair;
  for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = c[i];
  return pair;
}

// The same pair in one of its 72 orders: 2 orders of the triangles times 6 orders of each triangle's vertices.
template <class Real>
BasicPair<Real> reordered(const BasicPair<Real>& pair, int order) {
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  BasicPair<Real> result;
  for (int i = 0; i < 3; ++i) {
    result.a[i] = pair.a[kOrders[order % 6][i]];
    result.b[i] = pair.b[kOrders[order / 6 % 6][i]];
  }
  if (order >= 36) std::swap(result.a, result.b);
  return result;
}

// Permutes the axes in one of 6 ways (way % 6), and negates the axes whose bit in way / 6 is set. Nothing is rounded.
template <class Real>
BasicPair<Real> turned(const BasicPair<Real>& pair, int way) {
  static constexpr int kAxes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  BasicPair<Real> result;
  for (int i = 0; i < kCoordinates; ++i) {
    const Real c = coordinates(pair)[i / 3 * 3 + kAxes[way % 6][i % 3]];
    coordinates(result)[i] = (way / 6 >> i % 3 & 1) != 0 ? -c : c;
  }
  return result;
}

}  // namespace graze::oracle_test
