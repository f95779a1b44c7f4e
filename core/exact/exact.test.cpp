// SPDX-License-Identifier: Apache-2.0
// Hand-made examples and invariants of the exact decision. analysis/truth_over_strata.test.cpp compares it with the
// oracle in every stratum.
#include "core/exact/exact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace graze::exact {
namespace {

struct Example {
  const char* what;
  float a[9], b[9];
  Contact contact;
  int margin_sign;
  Hulls hulls;
};

const Example kExamples[] = {
    {"b pierces a", {0, 0, 0, 4, 0, 0, 0, 4, 0}, {1, 1, -1, 1, 1, 1, 3, 3, 1}, Contact::segment, -1, {2, 2, false}},
    {"apart", {0, 0, 0, 4, 0, 0, 0, 4, 0}, {0, 0, 1, 4, 0, 2, 0, 4, 3}, Contact::none, 1, {2, 2, false}},
    {"a vertex on the face",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {1, 1, 0, 1, 2, 4, 2, 1, 4},
     Contact::point,
     0,
     {2, 2, false}},
    {"an edge in the face",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {1, 1, 0, 2, 1, 0, 1, 1, 4},
     Contact::segment,
     0,
     {2, 2, false}},
    {"edges cross in a point",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {2, 0, -1, 2, 0, 1, 2, -4, 0},
     Contact::point,
     0,
     {2, 2, false}},
    {"coplanar, overlapping", {0, 0, 0, 4, 0, 0, 0, 4, 0}, {1, 1, 0, 5, 1, 0, 1, 5, 0}, Contact::area, 0, {2, 2, true}},
    {"coplanar, inside", {0, 0, 0, 8, 0, 0, 0, 8, 0}, {1, 1, 0, 3, 1, 0, 1, 3, 0}, Contact::area, 0, {2, 2, true}},
    {"coplanar, a common edge",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {0, 0, 0, 4, 0, 0, 0, -4, 0},
     Contact::segment,
     0,
     {2, 2, true}},
    {"coplanar, a common vertex",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {0, 0, 0, -4, 0, 0, 0, -4, 0},
     Contact::point,
     0,
     {2, 2, true}},
    {"coplanar, apart", {0, 0, 0, 4, 0, 0, 0, 4, 0}, {5, 5, 0, 9, 5, 0, 5, 9, 0}, Contact::none, 1, {2, 2, true}},
    {"a segment through the face",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {1, 1, -1, 1, 1, 1, 1, 1, 0},
     Contact::point,
     -1,
     {2, 1, false}},
    {"a segment in the plane",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {-1, 1, 0, 9, 1, 0, 2, 1, 0},
     Contact::segment,
     0,
     {2, 1, true}},
    {"a point in the face", {0, 0, 0, 4, 0, 0, 0, 4, 0}, {1, 1, 0, 1, 1, 0, 1, 1, 0}, Contact::point, 0, {2, 0, true}},
    {"a point beside the face",
     {0, 0, 0, 4, 0, 0, 0, 4, 0},
     {1, 1, 1, 1, 1, 1, 1, 1, 1},
     Contact::none,
     1,
     {2, 0, false}},
    {"segments cross", {0, 0, 0, 4, 4, 0, 2, 2, 0}, {0, 4, 0, 4, 0, 0, 4, 0, 0}, Contact::point, 0, {1, 1, true}},
    {"segments pass", {0, 0, 0, 4, 4, 0, 2, 2, 0}, {0, 4, 1, 4, 0, 1, 4, 0, 1}, Contact::none, 1, {1, 1, false}},
    {"segments overlap on a line",
     {0, 0, 0, 4, 4, 4, 2, 2, 2},
     {3, 3, 3, 9, 9, 9, 3, 3, 3},
     Contact::segment,
     0,
     {1, 1, true}},
    {"segments meet end to end",
     {0, 0, 0, 4, 4, 4, 2, 2, 2},
     {4, 4, 4, 9, 9, 9, 4, 4, 4},
     Contact::point,
     0,
     {1, 1, true}},
    {"segments apart on a line",
     {0, 0, 0, 1, 1, 1, 0, 0, 0},
     {4, 4, 4, 9, 9, 9, 4, 4, 4},
     Contact::none,
     1,
     {1, 1, true}},
    {"parallel segments", {0, 0, 0, 1, 1, 1, 0, 0, 0}, {0, 0, 1, 1, 1, 2, 0, 0, 1}, Contact::none, 1, {1, 1, true}},
    {"equal points", {1, 2, 3, 1, 2, 3, 1, 2, 3}, {1, 2, 3, 1, 2, 3, 1, 2, 3}, Contact::point, 0, {0, 0, true}},
    {"two points", {1, 2, 3, 1, 2, 3, 1, 2, 3}, {1, 2, 4, 1, 2, 4, 1, 2, 4}, Contact::none, 1, {0, 0, true}},
    {"zeros of either sign",
     {0, 0, 0, -0.0f, 0, 0, 0, -0.0f, 0},
     {-0.0f, 0, 0, 0, 0, 0, 0, 0, -0.0f},
     Contact::point,
     0,
     {0, 0, true}},
};

// Tests the example, moved and scaled so that the given kind of numbers must decide it.
template <class Real>
void expect_relation(const Example& example, Real scale, Real offset, const char* numbers) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int order = 0; order < 72; ++order) {
    Real a[9], b[9];
    for (int i = 0; i < 9; ++i) {
      const int p = kOrders[order % 6][i / 3], q = kOrders[order / 6 % 6][i / 3];
      a[i] = example.a[3 * p + i % 3] * scale + offset;
      b[i] = example.b[3 * q + i % 3] * scale + offset;
    }
    const bool meet = example.contact != Contact::none;
    Relation expected{meet ? Verdict::intersects : Verdict::disjoint, example.contact, example.margin_sign,
                      example.hulls};
    if (order >= 36) std::swap(expected.hulls.dimension_a, expected.hulls.dimension_b);
    EXPECT_EQ(order < 36 ? relation(a, b) : relation(b, a), expected) << example.what << ' ' << numbers << ' ' << order;
    EXPECT_EQ(order < 36 ? intersects(a, b) : intersects(b, a), meet) << example.what << ' ' << numbers;
  }
}

TEST(Exact, KnowsContactsInAllOrdersAndScales) {
  for (const Example& example : kExamples) {
    expect_relation<float>(example, 1, 0, "small integers");
    expect_relation<float>(example, 0x1p18f, 1, "24 bits");
    expect_relation<float>(example, 1, 0x1p20f, "far from the origin");
    expect_relation<float>(example, 0x1p-149f, 0, "subnormal");
    expect_relation<float>(example, 0x1p-149f, 0x1p-126f, "at the least normal number");
    expect_relation<float>(example, 0x1p124f, 0, "near the largest float");
  }
}

TEST(Exact, KnowsContactsOfDoublesInAllOrdersAndScales) {
  for (const Example& example : kExamples) {
    expect_relation<double>(example, 1, 0, "small integers");
    expect_relation<double>(example, 0x1p24, 1, "30 bits");
    expect_relation<double>(example, 0x1p34, 1, "40 bits");
    expect_relation<double>(example, 0x1p46, 1, "53 bits");
    expect_relation<double>(example, 1, 0x1p48, "far from the origin");
    expect_relation<double>(example, 0x1p-298, 0, "where bounds still hold");
    expect_relation<double>(example, 0x1p-340, 0, "where products of three underflow");
    expect_relation<double>(example, 0x1p298, 0, "where bounds no longer hold");
    expect_relation<double>(example, 0x1p340, 0, "where products of three overflow");
    expect_relation<double>(example, 0x1p-1074, 0, "subnormal");
    expect_relation<double>(example, 0x1p-1074, 0x1p-1022, "at the least normal number");
    expect_relation<double>(example, 0x1p1020, 0, "near the largest double");
  }
}

// A far vertex, which does not affect the contact, widens the grid to this many bits.
template <class Real>
void expect_decided_on_grid(int bits, Real tiny, Real huge) {
  const Real a[9] = {0, 0, 0, huge, 0, huge, 0, huge, huge};  // in z = x + y
  for (const Real height : {Real{0}, tiny, -tiny}) {
    const Real b[9] = {tiny, tiny, 2 * tiny + height, 1, 2, huge, 2, 1, huge};
    EXPECT_EQ(detail::grid_of(a, b).bits, bits);
    Stage stage;
    EXPECT_EQ(intersects(a, b, &stage), height <= 0) << tiny;
    EXPECT_TRUE(height != 0 || stage == Stage::wide);
    const Relation r = relation(a, b);
    EXPECT_EQ(r.intersects(), height <= 0) << tiny;
    EXPECT_EQ(r.contact, height > 0 ? Contact::none : height < 0 ? Contact::segment : Contact::point) << tiny;
    EXPECT_EQ(r.margin_sign, height > 0 ? 1 : height < 0 ? -1 : 0) << tiny;
  }
}

TEST(Exact, DecidesOnEveryGrid) {
  expect_decided_on_grid(277, 0x1p-149f, 0x1p127f);
  expect_decided_on_grid(61, 0x1p-8, 0x1p52);
  expect_decided_on_grid(90, 0x1p-37, 0x1p52);
  expect_decided_on_grid(299, 0x1p-200, 0x1p98);
  expect_decided_on_grid(2097, 0x1p-1074, 0x1p1022);
}

// For each kind of numbers for doubles, compares the largest determinants with those of a wider kind.
TEST(Exact, KindsForDoublesHoldWhatTheyPromise) {
  using namespace detail;
  std::mt19937_64 random(17);
  const auto decided = [&](auto numbers, int bits) {
    using Numbers = decltype(numbers);
    long zero = 0;
    for (int i = 0; i < 20'000; ++i) {
      double c[18];
      for (double& x : c) {
        const double most = std::ldexp(1.0, bits);
        const double near = std::nextafter(most, 0.0);
        x = random() % 3 == 0 ? 0 : std::ldexp(1.0, static_cast<int>(random() % static_cast<unsigned>(bits)));
        if (random() % 2) x = near >= 0x1p52 ? near : most - 1;
        if (random() % 2) x = -x;
      }
      if (i % 4 == 0) std::copy_n(c, 3, c + 9);  // makes determinants zero
      c[17] = 1;
      const Grid grid = grid_of(c, c + 9);
      ASSERT_TRUE(Numbers::holds(grid)) << grid.bits;
      const auto t = triangles<Numbers>(c, c + 9, grid.exponent);
      const auto u = triangles<HugeNumbers>(c, c + 9, grid.exponent);
      const auto found = determinant<Numbers>(t.a[0], t.a[1], t.a[2], t.b[i % 3]);
      const auto exact = determinant<HugeNumbers>(u.a[0], u.a[1], u.a[2], u.b[i % 3]);
      ASSERT_EQ(numbers.positive(found), HugeNumbers().positive(exact)) << bits << ' ' << i;
      ASSERT_EQ(numbers.negative(found), HugeNumbers().negative(exact)) << bits << ' ' << i;
      zero += numbers.zero(found);
    }
    EXPECT_GT(zero, 100) << bits;
  };
  decided(NarrowNumbers(), kNarrowBits);
  decided(IntNumbers(), kIntBits);
  decided(MediumNumbers(), kMediumBits);
  decided(LongNumbers(), kLongBits);
  decided(LargeNumbers(), kLargeBits);
}

// Every kind of numbers that can hold a pair must give the same result.
TEST(Exact, KindsOfNumbersAgree) {
  std::mt19937 random(5);
  const auto coordinate = [&] { return static_cast<float>(static_cast<int>(random() % 7) - 3); };
  int contacts[4] = {}, crossings = 0;
  for (int i = 0; i < 20'000; ++i) {
    float a[9], b[9];
    for (float& x : a) x = coordinate();
    for (float& x : b) x = coordinate();
    using namespace detail;
    const Relation r = by_axes(triangles<DoubleNumbers>(a, b));
    ++contacts[static_cast<int>(r.contact)];
    ASSERT_EQ(by_axes(triangles<NarrowNumbers>(a, b, 0)), r) << i;
    ASSERT_EQ(by_axes(triangles<IntNumbers>(a, b, 0)), r) << i;
    ASSERT_EQ(by_axes(triangles<ResidueNumbers>(a, b, 0)), r) << i;
    ASSERT_EQ(by_axes(triangles<WideNumbers>(a, b)), r) << i;
    ASSERT_EQ(decide<DoubleNumbers>(a, b, 0), r.intersects()) << i;
    ASSERT_EQ(decide<WideNumbers>(a, b, 0), r.intersects()) << i;
    // by_planes returns `crosses` if and only if no vertex is in the other's plane and the triangles more than touch.
    const Triangles<DoubleNumbers> t = triangles<DoubleNumbers>(a, b);
    const Finding found = by_planes(t);
    const bool apart_from_planes = (sides(t.a, normal<DoubleNumbers>(t.a), t.b, DoubleNumbers()).in |
                                    sides(t.b, normal<DoubleNumbers>(t.b), t.a, DoubleNumbers()).in) == 0;
    ASSERT_TRUE(found != Finding::crosses || (r.margin_sign == -1 && apart_from_planes)) << i;
    ASSERT_TRUE(r.margin_sign != -1 || !apart_from_planes || found == Finding::crosses) << i;
    crossings += found == Finding::crosses;
  }
  EXPECT_GT(crossings, 0);
  for (const int count : contacts) EXPECT_GT(count, 0);
}

// Grids up to the widest that residues hold. Coordinates have 24 bits; some are shifted by up to 10 bits. Triangles lie
// exactly or nearly in each other's planes, so determinants are zero, far below their products, or 108 bits wide.
TEST(Exact, ResiduesDecideAsIntegersOf128Bits) {
  std::mt19937_64 random(9);
  long by_contact[4] = {}, widest = 0, pairs = 0;
  for (int i = 0; i < 200'000; ++i) {
    using namespace detail;
    float c[18];
    const int shift = static_cast<int>(random() % 11), kind = i % 4;
    for (float& x : c) x = static_cast<float>(static_cast<std::int64_t>(random() & 0x1ffffff) - 0x1000000);
    if (kind == 1)  // puts vertices in each other's planes
      for (int k = 2; k < 18; k += 3) c[k] = 2 * c[k - 1] - (i % 3 == 0 && k == 17 ? 1.0f : 0.0f);
    if (kind == 2)  // puts a vertex on an edge, or near it
      for (int k = 0; k < 3; ++k) c[9 + k] = (c[k] + c[3 + k]) / 2;
    if (kind == 3)  // mixes small and large coordinates
      for (float& x : c) x = std::floor(std::ldexp(x, -static_cast<int>(random() % 25)));
    for (int k = 0; k < 18; k += 1 + static_cast<int>(random() % 3)) c[k] = std::ldexp(c[k], kind == 1 ? 0 : shift);
    if (kind == 2 && (i & 4)) c[9] = std::nextafter(c[9], INFINITY);
    const Grid grid = grid_of(c, c + 9);
    if (!ResidueNumbers::holds(grid)) continue;
    ++pairs;
    widest += grid.bits == kResidueBits;
    const Relation r = by_axes(triangles<IntNumbers>(c, c + 9, grid.exponent));
    ++by_contact[static_cast<int>(r.contact)];
    ASSERT_EQ(by_axes(triangles<ResidueNumbers>(c, c + 9, grid.exponent)), r) << i;
    ASSERT_EQ(decide<ResidueNumbers>(c, c + 9, grid.exponent), r.intersects()) << i;
  }
  EXPECT_GT(pairs, 100'000);
  EXPECT_GT(widest, 5'000);
  for (const long count : by_contact) EXPECT_GT(count, 100);
}

// Tests segments and points in space, in one plane and on one line, and against triangles whose plane contains them.
TEST(Exact, SegmentsAndPointsMeetAsTheAxesSay) {
  std::mt19937_64 random(11);
  const auto small = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most; };
  long by_contact[4] = {}, both_flat = 0, points = 0;
  for (int i = 0; i < 100'000; ++i) {
    using namespace detail;
    int d[3], e[3], up[3] = {};
    for (int k = 0; k < 3; ++k) d[k] = small(2), e[k] = small(2);
    if (i % 4 == 0) up[i / 4 % 3] = small(1);  // mostly in the plane of d and e
    const auto factor = static_cast<float>(random() % 0x20000 | 1);
    float c[18];
    for (int v = 0; v < 6; ++v) {
      const bool in_b = v > 2;
      const int along_d = in_b && i % 3 == 1 ? 0 : small(3), along_e = in_b && i % 3 != 0   ? small(3)
                                                                       : i % 5 == 0 && in_b ? 1
                                                                                            : 0;
      for (int k = 0; k < 3; ++k)
        c[3 * v + k] = factor * static_cast<float>(along_d * d[k] + along_e * e[k] + (in_b ? up[k] : 0));
    }
    if (random() & 1) std::swap_ranges(c, c + 9, c + 9);
    const Grid grid = grid_of(c, c + 9);
    ASSERT_TRUE(NarrowNumbers::holds(grid));
    const Relation r = by_axes(triangles<IntNumbers>(c, c + 9, grid.exponent));
    ASSERT_EQ(decide<NarrowNumbers>(c, c + 9, grid.exponent), r.intersects()) << i;
    ASSERT_EQ(decide<ResidueNumbers>(c, c + 9, grid.exponent), r.intersects()) << i;
    ASSERT_EQ(decide<WideNumbers>(c, c + 9, grid.exponent), r.intersects()) << i;
    if (DoubleNumbers::holds(grid)) {
      ASSERT_EQ(decide<DoubleNumbers>(c, c + 9, grid.exponent), r.intersects()) << i;
    }
    ++by_contact[static_cast<int>(r.contact)];
    both_flat += r.hulls.dimension_a < 2 && r.hulls.dimension_b < 2;
    points += r.hulls.dimension_a == 0 || r.hulls.dimension_b == 0;
  }
  EXPECT_GT(both_flat, 10'000);
  EXPECT_GT(points, 500);
  for (int contact = 0; contact < 3; ++contact) EXPECT_GT(by_contact[contact], 1'000) << contact;
}

// Coordinates whose magnitudes differ by a factor of up to 2^200, so that only wide integers can hold a pair.
TEST(Exact, SegmentsOfAnySizeMeetTrianglesAsTheAxesSay) {
  std::mt19937_64 random(13);
  const auto coordinate = [&] {
    return std::ldexp(static_cast<float>(static_cast<int>(random() % 4001) - 2000),
                      static_cast<int>(random() % 200) - 120);
  };
  long by_contact[4] = {}, wide = 0;
  for (int i = 0; i < 20'000; ++i) {
    float c[18];
    for (float& x : c) x = coordinate();
    if (i % 3 == 0) {  // puts them in one coordinate plane, where they meet more often
      for (int k = i % 2; k < 18; k += 3) c[k] = 0;
    }
    if (i % 2 == 0) std::copy_n(c + 3 * (i / 2 % 2), 3, c + 6);  // a is a segment
    if (i % 5 == 0) std::copy_n(c + 9, 3, c + 15);               // b is a segment
    for (int k = 0; i % 7 == 0 && k < 3; ++k)
      c[9 + k] = 2 * c[k];  // b begins on the line through a's first vertex and the origin
    if (random() & 1) std::swap_ranges(c, c + 9, c + 9);
    Stage stage;
    const Relation r = detail::by_axes(detail::triangles<detail::WideNumbers>(c, c + 9));
    ASSERT_EQ(intersects(c, c + 9, &stage), r.intersects()) << i;
    ++by_contact[static_cast<int>(r.contact)];
    wide += stage == Stage::wide;
  }
  EXPECT_GT(wide, 2'000);
  EXPECT_GT(by_contact[0], 100);
  EXPECT_GT(by_contact[1], 100);
}

// Compares products of two 35-bit differences: equal products, the closest ones, and products that differ in doubles.
TEST(Exact, ResiduesKnowTheSignsOfMinors) {
  using detail::Whole;
  std::mt19937_64 random(12);
  const auto difference = [&] {
    return static_cast<double>(static_cast<std::int64_t>(random() >> 29) - (std::int64_t{1} << 34));
  };
  long small = 0;
  for (int i = 0; i < 200'000; ++i) {
    double p = difference(), q = difference(), r = q, s = p;
    if (i % 4 == 1) r += static_cast<double>(i % 3 - 1), s -= static_cast<double>(i % 5 - 2);
    if (i % 4 == 2) p = 0x1p34 - i % 7, q = 0x1p34 + i % 5, r = s = 0x1p34 - i % 3;
    if (i % 4 == 3) r = difference(), s = difference();
    const __int128 exact =
        static_cast<__int128>(p) * static_cast<__int128>(q) - static_cast<__int128>(r) * static_cast<__int128>(s);
    small += exact != 0 && -0x200000 < exact && exact < 0x200000;
    ASSERT_EQ(sign_of_difference(Whole{p}, Whole{q}, Whole{r}, Whole{s}), (exact > 0) - (exact < 0)) << i;
  }
  EXPECT_GT(small, 100);
}

// Tests the limits of residues: the largest determinant, 2^62 and its neighbours, and zero.
TEST(Exact, ResiduesKnowTheirSigns) {
  using detail::Residue, detail::Whole;
  const double most = 0x1p35 - 1;
  for (const double edge : {1.0, 3.0, 0x1p25 - 1, 0x1p25, most}) {
    for (const double other : {1.0, 0x1p26 + 1, most}) {
      // Compares x y z - u v w with 128-bit integers, with factors in every order of size.
      const double of[6] = {edge, other, most, most, edge, other};
      for (int less = -2; less <= 2; ++less) {
        const auto product = [](double x, double y, double z) { return Residue(Whole{x}) * Whole{y} * Whole{z}; };
        const Residue found = product(of[0], of[1], of[2]) - product(of[3], of[4], of[5]) + Residue(less);
        EXPECT_EQ(found.sign(), (less > 0) - (less < 0)) << edge << ' ' << other << ' ' << less;
        const Residue large = product(of[0], of[1], of[2]) + Residue(less), minus = Residue(0) - large;
        const auto exact =
            static_cast<__int128>(of[0]) * static_cast<__int128>(of[1]) * static_cast<__int128>(of[2]) + less;
        EXPECT_EQ(large.sign(), (exact > 0) - (exact < 0));
        EXPECT_EQ(minus.sign(), -large.sign());
      }
    }
  }
}

// Tests the bounds that error_bound.h derives. No pair in the other tests comes near these bounds.
TEST(ErrorBound, IsShewchuksAndNoMoreThanAFewPercentAbove) {
  const double e = 0x1p-53, stage_a = (7 + 56 * e) * e;
  EXPECT_GE(detail::kDeterminantError, stage_a);
  EXPECT_LE(detail::kDeterminantError, 1.2 * stage_a);
  EXPECT_GE(detail::determinant_error<float>({3, 5, 7}), 6 * stage_a * 3 * 5 * 7);
  EXPECT_LE(detail::determinant_error<float>({3, 5, 7}), 1.2 * 6 * stage_a * 3 * 5 * 7);
}

TEST(Exact, WideIntegersMultiplyByOneLimb) {
  using detail::Int128, detail::Wide;
  std::mt19937_64 random(19);
  for (int i = 0; i < 100'000; ++i) {
    const auto l = static_cast<Int128>(static_cast<std::int64_t>(random())) * static_cast<std::int64_t>(random() >> 2);
    const auto r = static_cast<std::int64_t>(i % 5 == 0 ? random() & 1 : random());
    ASSERT_TRUE(Wide<3>(l) * r == Wide<3>(l) * Wide<3>(Int128{r})) << i;
  }
}

TEST(Exact, WideIntegersMultiplyAndCompare) {
  using detail::Wide;
  const auto wide = [](std::int64_t x) { return Wide<5>(detail::Int128{x}); };
  const std::int64_t values[] = {0, 1, -1, 3, -7, 1ll << 62, -(1ll << 62), 0x7fffffffffffffff};
  for (const std::int64_t l : values) {
    for (const std::int64_t r : values) {
      const detail::Int128 product = static_cast<detail::Int128>(l) * r;
      const Wide<9> found = Wide<9>(wide(l)) * wide(r);
      EXPECT_EQ(found.limb[0], static_cast<std::uint64_t>(product));
      EXPECT_EQ(found.limb[1], static_cast<std::uint64_t>(product >> 64));
      EXPECT_EQ(found.negative(), product < 0);
      EXPECT_EQ(wide(l) < wide(r), l < r);
      EXPECT_EQ(wide(l) == wide(r), l == r);
    }
  }
}

// With -fsanitize=shift,bounds, GCC 12 miscompiles the shifted comparison of an array element.
[[gnu::noinline]] unsigned shifted_comparisons(const double (&of)[4]) {
  const double heights[4] = {of[0], of[1], of[2], of[3]};
  unsigned above = 0;
  for (unsigned k = 0; k < 4; ++k) above |= unsigned{heights[k] > 0} << k;
  return above;
}
[[gnu::noinline]] unsigned comparisons_that_shift(const double (&of)[4]) {
  const double heights[4] = {of[0], of[1], of[2], of[3]};
  unsigned above = 0;
  for (unsigned k = 0; k < 4; ++k) {
    if (heights[k] > 0) above |= 1u << k;
  }
  return above;
}

TEST(Compiler, PacksSignsAsExactDoes) {
  int wrong = 0;
  for (unsigned signs = 0; signs < 16; ++signs) {
    double heights[4];
    for (unsigned k = 0; k < 4; ++k) heights[k] = (signs & 1u << k) != 0 ? 1 : -1;
    EXPECT_EQ(comparisons_that_shift(heights), signs);
    if (shifted_comparisons(heights) != signs) ++wrong;
  }
  if (wrong > 0) GTEST_SKIP() << "this compiler miscompiles the shift of a comparison, " << wrong << " of 16 times";
}

}  // namespace
}  // namespace graze::exact
