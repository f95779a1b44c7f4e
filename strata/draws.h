// SPDX-License-Identifier: Apache-2.0
// The random words of one pair, and the numbers and vectors that strata make from them. A draft is a pair before its
// coordinates are rounded, once, to their type. The bits are the same on every machine, because the code calls no
// library function that rounds.
#pragma once

#include <Random123/philox.h>

#include <cstdint>
#include <cstring>

#include "core/pair.h"

// Inlining on a device keeps the state of a pair's draws in registers, and lets the compiler know the number of draws.
#ifdef __CUDACC__
#define GRAZE_INLINE __host__ __device__ __forceinline__
#else
#define GRAZE_INLINE inline
#endif

namespace graze::strata {
inline namespace GRAZE_FP {

using Vec = Vec3<double>;

// The random words of one pair, in order: Philox4x32-10 with the seed as its key. The counter is the index (two words),
// the stratum and the block number. The order of draws is part of a stratum's definition. C++ does not define the order
// of evaluation within an expression, except in braces, so use one draw per expression, or braces.
struct Draws {
  philox4x32_key_t key;
  philox4x32_ctr_t counter;
  philox4x32_ctr_t block;
  int used = 4;  // words of the current block used so far

  GRAZE_HD Draws(std::uint64_t seed, std::uint32_t stratum, std::uint64_t index)
      : key{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
        counter{{static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), stratum, 0}},
        block{} {}

  GRAZE_INLINE std::uint32_t word() {
    if (used == 4) {
      block = philox4x32_R(10, counter, key);
      ++counter.v[3];
      used = 0;
    }
    return block.v[used++];
  }

  // A whole number from 0 to n - 1, with a negligible bias of n / 2^32.
  GRAZE_INLINE std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(word()) * n >> 32);
  }

  GRAZE_INLINE bool coin() { return below(2) != 0; }

  // A whole number from -reach to reach.
  GRAZE_INLINE int integer(int reach) {
    return static_cast<int>(below(2 * static_cast<std::uint32_t>(reach) + 1)) - reach;
  }

  // A whole number from low to high.
  GRAZE_INLINE int between(int low, int high) {
    return low + static_cast<int>(below(static_cast<std::uint32_t>(high - low + 1)));
  }

  GRAZE_INLINE double sign() { return coin() ? 1.0 : -1.0; }

  // A multiple of 2^-31 in [-1, 1).
  GRAZE_INLINE double real() { return static_cast<std::int32_t>(word()) * 0x1p-31; }

  // A multiple of 2^-32 in (0, 1].
  GRAZE_INLINE double positive() { return (word() + 1.0) * 0x1p-32; }

  // A multiple of 2^-23 in [-1, 1): every value is a float.
  GRAZE_INLINE float real_float() { return static_cast<float>(static_cast<std::int32_t>(word()) >> 8) * 0x1p-23f; }

  GRAZE_INLINE Vec reals() { return {real(), real(), real()}; }

  GRAZE_INLINE Vec integers(int reach) {
    return {static_cast<double>(integer(reach)), static_cast<double>(integer(reach)),
            static_cast<double>(integer(reach))};
  }

  // Constants for the coordinate type: kBits, the number of significant bits, and exponents of two: of the smallest
  // gap, the largest offset, the flattest sliver, the largest ratio of axes, and the range of scales.
  using Real = float;
  using Integer = int;
  static constexpr int kBits = 24, kGap = 40, kOffset = 22, kSliver = 22, kRatio = 20, kLeastScale = -149,
                       kMostScale = 126;
  GRAZE_INLINE int wide_bits() { return kBits; }
};

// The draws of a pair of doubles. Reals have 53 bits, and wide integers have 16 to 53 bits.
struct DoubleDraws : Draws {
  using Draws::Draws;
  using Draws::integer;
  using Draws::integers;

  GRAZE_INLINE std::uint64_t long_word() {
    const std::uint64_t high = word();
    return high << 32 | word();
  }

  // A whole number from -reach to reach.
  GRAZE_INLINE std::int64_t integer(std::int64_t reach) {
    const std::uint64_t count = 2 * static_cast<std::uint64_t>(reach) + 1;
    const auto drawn = static_cast<unsigned __int128>(long_word()) * count >> 64;
    return static_cast<std::int64_t>(drawn) - reach;
  }

  // A multiple of 2^-52 in [-1, 1).
  GRAZE_INLINE double real() { return static_cast<double>(static_cast<std::int64_t>(long_word()) >> 11) * 0x1p-52; }

  // A multiple of 2^-52 in (0, 1].
  GRAZE_INLINE double positive() { return static_cast<double>((long_word() >> 12) + 1) * 0x1p-52; }

  GRAZE_INLINE double real_float() { return real(); }

  GRAZE_INLINE Vec reals() { return {real(), real(), real()}; }

  GRAZE_INLINE Vec integers(std::int64_t reach) {
    return {static_cast<double>(integer(reach)), static_cast<double>(integer(reach)),
            static_cast<double>(integer(reach))};
  }

  using Real = double;
  using Integer = std::int64_t;
  static constexpr int kBits = 53, kGap = 100, kOffset = 50, kSliver = 50, kRatio = 100, kLeastScale = -1074,
                       kMostScale = 1022;
  GRAZE_INLINE int wide_bits() { return between(16, kBits); }
};

// 2^exponent.   Requires: the result is a normal double.
GRAZE_INLINE double power_of_two(int exponent) {
  const std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}

// The float or double that is `ulps` steps above x, or below x if `ulps` is negative. Steps may cross zero and the
// subnormals.   Requires: no step exceeds the largest number.
GRAZE_INLINE float nudged(float x, int ulps) {
  constexpr std::uint32_t kSign = 0x80000000u;
  std::uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  const std::int32_t distance = static_cast<std::int32_t>(bits & ~kSign);
  const std::int32_t position = (bits & kSign ? -distance : distance) + ulps;
  bits = position < 0 ? kSign | static_cast<std::uint32_t>(-position) : static_cast<std::uint32_t>(position);
  memcpy(&x, &bits, sizeof x);
  return x;
}

GRAZE_INLINE double nudged(double x, int ulps) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  std::uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  const std::int64_t distance = static_cast<std::int64_t>(bits & ~kSign);
  const std::int64_t position = (bits & kSign ? -distance : distance) + ulps;
  bits = position < 0 ? kSign | static_cast<std::uint64_t>(-position) : static_cast<std::uint64_t>(position);
  memcpy(&x, &bits, sizeof x);
  return x;
}

GRAZE_INLINE Vec unit_axis(int axis) { return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}; }

// v scaled so that its largest component is ±1; an axis if v is zero.
GRAZE_INLINE Vec normalised(const Vec& v) {
  const double largest = magnitude(component(v, dominant_axis(v)));
  return largest > 0 ? v * (1 / largest) : unit_axis(0);
}

// v or -v, whichever points to the same side as `direction`.
GRAZE_INLINE Vec toward(const Vec& direction, const Vec& v) { return v * (dot(direction, v) < 0 ? -1.0 : 1.0); }

struct Draft {
  Vec a[3];
  Vec b[3];
};

GRAZE_INLINE void move(Vec (&triangle)[3], const Vec& by) {
  for (Vec& vertex : triangle) vertex = vertex + by;
}
GRAZE_INLINE void move(Draft& draft, const Vec& by) {
  move(draft.a, by);
  move(draft.b, by);
}

// Scales each axis by its own factor.
GRAZE_INLINE void scale(Vec (&triangle)[3], const Vec& by) {
  for (Vec& vertex : triangle) vertex = {vertex.x * by.x, vertex.y * by.y, vertex.z * by.z};
}
GRAZE_INLINE void scale(Draft& draft, const Vec& by) {
  scale(draft.a, by);
  scale(draft.b, by);
}
GRAZE_INLINE void scale(Draft& draft, double size) { scale(draft, {size, size, size}); }

GRAZE_INLINE Vec3<float> rounded(const Vec& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

GRAZE_INLINE Pair rounded(const Draws&, const Draft& draft) {
  Pair pair;
  for (int i = 0; i < 3; ++i) {
    pair.a[i] = rounded(draft.a[i]);
    pair.b[i] = rounded(draft.b[i]);
  }
  return pair;
}

GRAZE_INLINE DoublePair rounded(const DoubleDraws&, const Draft& draft) {
  return {{draft.a[0], draft.a[1], draft.a[2]}, {draft.b[0], draft.b[1], draft.b[2]}};
}

// The pair in a random one of its 72 vertex orders, so that a stratum's contacts do not all have the same order.
template <class Real>
GRAZE_INLINE BasicPair<Real> shuffled(Draws& draws, const BasicPair<Real>& pair) {
  const std::uint32_t order = draws.below(72);
  const bool swap = order % 2 != 0;
  const int turn_a = static_cast<int>(order / 2 % 3), turn_b = static_cast<int>(order / 6 % 3);
  const int step_a = order / 18 % 2 != 0 ? 2 : 1, step_b = order / 36 != 0 ? 2 : 1;
  // Selects without indexing, which on a device would move the pair from registers to memory.
  const auto choose = [](bool first, const Vec3<Real>& u, const Vec3<Real>& v) -> Vec3<Real> {
    return {first ? u.x : v.x, first ? u.y : v.y, first ? u.z : v.z};
  };
  const auto at = [&](const Vec3<Real>(&v)[3], int k) { return choose(k == 0, v[0], choose(k == 1, v[1], v[2])); };
  BasicPair<Real> result;
  for (int i = 0; i < 3; ++i) {
    const Vec3<Real> a = at(pair.a, (turn_a + step_a * i) % 3), b = at(pair.b, (turn_b + step_b * i) % 3);
    result.a[i] = choose(swap, b, a);
    result.b[i] = choose(swap, a, b);
  }
  return result;
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
