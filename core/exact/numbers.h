// SPDX-License-Identifier: Apache-2.0
// The kinds of numbers for decisions, and the choice of the smallest exact kind that holds a pair. Kinds that are not
// always exact report when they are not. If coordinates on the pair's grid have B bits, differences have B + 1, and a
// determinant is less than 6 times the product of three differences. The list gives the number of bits in coordinates:
//   bounded    doubles with an error bound; see core/exact/error_bound.h
//   doubles    up to 15 bits: less than 6 * 2^(3 * 16) < 2^53, so nothing rounds; floats likewise up to 6 bits:
//              6 * 2^(3 * 7) < 2^24
//   residue    up to 34 bits, on devices: a double, and an integer modulo 2^64 for use when the double is small
//   int128     up to 30 bits: minors fit in 64 bits; up to 40 bits: less than 6 * 2^(3 * 41) < 2^127
//   wide       up to 61 bits: a difference is less than 2^62, a minor than 2^125, a determinant than 6 * 2^186 < 2^189;
//              up to 90 bits: a minor is less than 2 * 2^(2 * 91) < 2^191, a determinant than 6 * 2^(3 * 91) < 2^319;
//              all floats, as multiples of 2^-149: a float has 277 bits, a difference 278, a determinant less than 840;
//              doubles up to 300 bits: a difference has 301, a minor 603, a determinant less than 906;
//              all doubles, up to 2,098 bits: a difference has 2,099, a minor 4,199, a determinant less than 6,300
// Integers do not round, so exact results do not depend on rounding mode, contraction or optimisation.
#pragma once

#include <cstdint>

#include "core/exact/error_bound.h"
#include "core/exact/grid.h"
#include "core/exact/relation.h"
#include "core/exact/residue.h"
#include "core/exact/vector.h"
#include "core/exact/wide_integer.h"

namespace graze::exact {

// Which kind of numbers decided. `bounded` includes triangles that share a vertex.
enum class Stage : std::uint8_t { bounded, doubles, int128, wide };
inline constexpr int kStages = 4;

namespace detail {

// In each kind, D holds coordinates and their differences, M minors, and T determinants. positive, negative and zero
// are true only if the determinant's sign is certain.
struct BoundedNumbers {
  using D = double;
  using M = Bounded;
  using T = Bounded;
  GRAZE_HD bool positive(const T& x) const { return x.value > kDeterminantError * x.size; }
  GRAZE_HD bool negative(const T& x) const { return x.value < -kDeterminantError * x.size; }
  GRAZE_HD bool zero(const T& x) const { return x.size == 0; }
  GRAZE_HD bool is_proper(const Vec<M>&) const { return false; }
};

// Exact numbers for grids of up to `bits` bits.
template <class Difference, class Minor, class Determinant, int bits, Stage stage>
struct ExactNumbers {
  using D = Difference;
  using M = Minor;
  using T = Determinant;
  static constexpr Stage kStage = stage;
  GRAZE_HD static bool holds(const Grid& grid) { return grid.bits <= bits; }
  GRAZE_HD bool positive(const T& x) const { return x > T(0); }
  GRAZE_HD bool negative(const T& x) const { return x < T(0); }
  GRAZE_HD bool zero(const T& x) const { return x == T(0); }
  GRAZE_HD bool is_proper(const Vec<M>& normal) const { return !is_zero(normal); }
};

inline constexpr int kSingleBits = 6, kResidueBits = 34, kDoubleBits = 15, kNarrowBits = 30, kIntBits = 40,
                     kMediumBits = 61, kLongBits = 90, kLargeBits = 300;
inline constexpr int kFloatBits = 277, kAllBits = 2098;  // bits of floats as multiples of 2^-149, and of doubles
using DoubleNumbers = ExactNumbers<double, double, double, kDoubleBits, Stage::doubles>;
using NarrowNumbers = ExactNumbers<std::int64_t, std::int64_t, Int128, kNarrowBits, Stage::int128>;
using IntNumbers = ExactNumbers<std::int64_t, Int128, Int128, kIntBits, Stage::int128>;
using LongNumbers = ExactNumbers<Wide<2>, Wide<3>, Wide<5>, kLongBits, Stage::wide>;
using WideNumbers = ExactNumbers<Wide<5>, Wide<9>, Wide<14>, kFloatBits, Stage::wide>;

// Kinds for pairs of doubles.
struct ModerateDoubleNumbers : DoubleNumbers {
  GRAZE_HD static bool holds(const Grid& grid) { return grid.bits <= kDoubleBits && is_moderate(grid); }
};
using MediumNumbers = ExactNumbers<std::int64_t, Int128, Wide<3>, kMediumBits, Stage::wide>;
using LargeNumbers = ExactNumbers<Wide<5>, Wide<10>, Wide<15>, kLargeBits, Stage::wide>;
using HugeNumbers = ExactNumbers<Wide<33>, Wide<66>, Wide<99>, kAllBits, Stage::wide>;

// For devices. Coordinates are not scaled, so the exponent is limited to keep determinants in the range of a float.
struct SingleNumbers : ExactNumbers<float, float, float, kSingleBits, Stage::doubles> {
  GRAZE_HD static bool holds(const Grid& grid) {
    return grid.bits <= kSingleBits && grid.exponent >= -30 && grid.exponent <= 30;
  }
};

using ResidueNumbers = ExactNumbers<Whole, Residue, Residue, kResidueBits, Stage::int128>;

// Kinds of numbers, the smallest first.
template <class Kind, class... Larger>
struct NumberKinds {
  // The index of the first kind that holds the grid: the number of kinds that are too small for it.
  GRAZE_HD static int place(const Grid& grid) { return (int{!Kind::holds(grid)} + ... + int{!Larger::holds(grid)}); }

  GRAZE_HD static bool hold(const Grid& grid) { return (Kind::holds(grid) || ... || Larger::holds(grid)); }

  // Calls visit(kind) with the first kind that holds the grid. The last kind needs no test, because hold(grid) is true.
  // Requires: hold(grid).   Returns: the result of visit.
  template <class Visit>
  GRAZE_HD static auto visit(const Grid& grid, const Visit& visit) {
    if constexpr (sizeof...(Larger) > 0) {
      if (!Kind::holds(grid)) return NumberKinds<Larger...>::visit(grid, visit);
    }
    return visit(Kind());
  }
};
using MultiwordNumbers = NumberKinds<LongNumbers, WideNumbers>;

// The kinds of numbers for a coordinate type. Machine: so cheap that all determinants are computed exactly. Multiword:
// a bound is tried first for each determinant.
template <class Real>
struct KindsFor {
  using Machine = NumberKinds<DoubleNumbers, NarrowNumbers, IntNumbers>;
  using Multiword = MultiwordNumbers;
  using All = NumberKinds<DoubleNumbers, NarrowNumbers, IntNumbers, LongNumbers, WideNumbers>;
};
template <>
struct KindsFor<double> {
  using Machine = NumberKinds<ModerateDoubleNumbers, NarrowNumbers, IntNumbers>;
  using Multiword = NumberKinds<MediumNumbers, LongNumbers, LargeNumbers, HugeNumbers>;
  using All = NumberKinds<ModerateDoubleNumbers, NarrowNumbers, IntNumbers, MediumNumbers, LongNumbers, LargeNumbers,
                          HugeNumbers>;
};

}  // namespace detail
}  // namespace graze::exact
