// SPDX-License-Identifier: Apache-2.0
// Compares CGAL's verdict and GMP's contact with each other, in all orders, and with CGAL's exact intersection.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include "oracle/integer_pair.h"
#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using oracle_test::Kind;
using oracle_test::PairSource;

constexpr std::uint64_t kSeed = 20240501;

TEST(Verdict, BothDecisionsAgree) {
  for (const Kind kind : oracle_test::kKinds) {
    PairSource source(kind, kSeed);
    int intersecting = 0;
    for (int n = 0; n < 40000; ++n) {
      const Pair pair = source.next();
      const bool intersects = cgal_verdict(pair) == Verdict::intersects;
      intersecting += intersects;
      ASSERT_EQ(intersects, gmp_contact(pair) != Contact::none) << hex(pair);
    }
    EXPECT_GT(intersecting, 1000) << "kind " << static_cast<int>(kind);
  }
}

TEST(Verdict, BothDecisionsIgnoreOrderAxesAndSigns) {
  for (const Kind kind : oracle_test::kKinds) {
    PairSource source(kind, kSeed + 1);
    for (int n = 0; n < 150; ++n) {
      const Pair pair = source.next();
      const Verdict verdict = cgal_verdict(pair);
      const Contact contact = gmp_contact(pair);
      for (int order = 0; order < 72; ++order) {
        const Pair other = oracle_test::turned(oracle_test::reordered(pair, order), source.below(48));
        ASSERT_EQ(cgal_verdict(other), verdict) << hex(other);
        ASSERT_EQ(gmp_contact(other), contact) << hex(other);
      }
    }
  }
}

// A pair that needs more than 40 bits is decided with doubles or large integers. Scaling each axis by a power of two
// makes the same pair need more or fewer bits. This map is affine, so the verdict must not change.
TEST(Verdict, SmallAndWideKernelsAgree) {
  for (const Kind kind : {Kind::lattice1, Kind::lattice3, Kind::degenerate, Kind::flat, Kind::near, Kind::coplanar}) {
    PairSource source(kind, kSeed + 2);
    for (int n = 0; n < 20000; ++n) {
      const Pair pair = source.next();
      Pair wide = pair;
      for (int i = 0; i < kCoordinates; ++i) {
        float& c = coordinates(wide)[i];
        c = std::ldexp(c, i % 3 == 0 ? 60 : i % 3 == 1 ? -60 : 3);
      }
      ASSERT_EQ(cgal_verdict(wide), cgal_verdict(pair)) << hex(pair);
      ASSERT_EQ(gmp_contact(wide), gmp_contact(pair)) << hex(pair);
    }
  }
}

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;

// Converts the result of CGAL's intersection to a contact. The result may be a polygon with three or more vertices.
struct ContactOf {
  using result_type = Contact;
  Contact operator()(const Exact::Point_3&) const { return Contact::point; }
  Contact operator()(const Exact::Segment_3&) const { return Contact::segment; }
  Contact operator()(const Exact::Triangle_3&) const { return Contact::area; }
  Contact operator()(const std::vector<Exact::Point_3>&) const { return Contact::area; }
};

template <class A, class B>
Contact constructed_contact(const A& a, const B& b) {
  const auto common = CGAL::intersection(a, b);
  return common ? boost::apply_visitor(ContactOf(), *common) : Contact::none;
}

Exact::Triangle_3 exact_triangle(const Vec3<float> (&p)[3]) {
  const auto point = [](const Vec3<float>& v) { return Exact::Point_3(v.x, v.y, v.z); };
  return {point(p[0]), point(p[1]), point(p[2])};
}

TEST(Contact, AgreesWithCgalsConstructedIntersection) {
  int seen[4] = {};
  for (const Kind kind :
       {Kind::lattice1, Kind::lattice3, Kind::near, Kind::coplanar, Kind::touching, Kind::degenerate, Kind::wide}) {
    PairSource source(kind, kSeed + 3);
    for (int n = 0; n < 1500; ++n) {
      const Pair pair = source.next();
      const Exact::Triangle_3 a = exact_triangle(pair.a), b = exact_triangle(pair.b);
      Contact expected;
      if (!a.is_degenerate() && !b.is_degenerate()) {
        expected = constructed_contact(a, b);
      } else if (a.is_degenerate() && b.is_degenerate()) {
        continue;
      } else {
        // One triangle is flat: intersect the other with the flat one's longest edge, which contains its other edges.
        const Exact::Triangle_3 &flat = a.is_degenerate() ? a : b, &full = a.is_degenerate() ? b : a;
        Exact::Segment_3 longest(flat[0], flat[1]);
        for (int i = 1; i < 3; ++i) {
          const Exact::Segment_3 edge(flat[i], flat[i + 1]);
          if (edge.squared_length() > longest.squared_length()) longest = edge;
        }
        if (longest.is_degenerate()) continue;
        expected = constructed_contact(full, longest);
      }
      ASSERT_EQ(gmp_contact(pair), expected) << hex(pair);
      ++seen[static_cast<int>(expected)];
    }
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

TEST(IntegerPair, GridIsTheCoarsestThatHoldsAllCoordinates) {
  const Pair pair = oracle_test::pair_of({0.5f, 3, 0, -24, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.0f});
  const Grid grid = grid_of(pair);
  EXPECT_EQ(grid.exponent, -1);
  EXPECT_EQ(grid.bits, 6);  // 48 has 6 bits
  EXPECT_EQ(small_integers(pair, grid).a[0], (Vec3<std::int64_t>{1, 6, 0}));
  EXPECT_EQ(small_integers(pair, grid).a[1].x, -48);
}

TEST(IntegerPair, ScaledBackGivesTheFloats) {
  for (const Kind kind : {Kind::raw_bits, Kind::wide, Kind::uniform}) {
    PairSource source(kind, kSeed + 4);
    for (int n = 0; n < 1000; ++n) {
      const Pair pair = source.next();
      const Grid grid = grid_of(pair);
      const LargePair large = large_integers(pair, grid);
      for (int i = 0; i < kCoordinates; ++i) {
        const mpz_class& integer = component(i < 9 ? large.a[i / 3] : large.b[i / 3 - 3], i % 3);
        ASSERT_EQ(std::ldexp(integer.get_d(), grid.exponent), static_cast<double>(coordinates(pair)[i]));
        if (grid.is_small()) {
          const SmallPair small = small_integers(pair, grid);
          const std::int64_t same = component(i < 9 ? small.a[i / 3] : small.b[i / 3 - 3], i % 3);
          ASSERT_EQ(integer, mpz_class(static_cast<long>(same)));
        }
      }
    }
  }
}

}  // namespace
}  // namespace graze::oracle
