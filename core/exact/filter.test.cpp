// SPDX-License-Identifier: Apache-2.0
// The filter has an SSE2 version and a portable one. Both versions must return the same correct finding for every pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/exact/exact.h"
#include "core/exact/filter_portable.h"

namespace graze::exact::detail {
namespace {

struct Coordinates {
  float a[9], b[9];
};

using Random = std::mt19937;

float uniform(Random& random) { return std::uniform_real_distribution<float>(-1, 1)(random); }

Coordinates draw(Random& random, const std::function<float()>& coordinate) {
  Coordinates c;
  for (float& x : c.a) x = coordinate();
  for (float& x : c.b) x = coordinate();
  std::shuffle(&c.a[0], &c.a[9], random);
  return c;
}

Coordinates uniform_pair(Random& random) {
  return draw(random, [&] { return uniform(random); });
}

// Integers from -2 to 2: many pairs are coplanar, touching or degenerate, or have a vertex in the other's plane.
Coordinates lattice_pair(Random& random) {
  return draw(random, [&] { return static_cast<float>(static_cast<int>(random() % 5) - 2); });
}

// Magnitudes from 2^-149 to 2^127.
Coordinates wide_pair(Random& random) {
  return draw(random, [&] { return std::ldexp(uniform(random), static_cast<int>(random() % 277) - 149); });
}

// Coordinates so small or so large that products of three leave the range of float.
Coordinates extreme_pair(Random& random) {
  const int exponent = random() % 2 == 0 ? -140 : 120;
  return draw(random, [&] { return std::ldexp(uniform(random), exponent); });
}

// Up to rounding, b[0] lies on a's face, or b is a segment across a's first edge. Determinants are near their bounds.
Coordinates near_pair(Random& random) {
  Coordinates c = uniform_pair(random);
  const float s = std::abs(uniform(random)) / 2, t = random() % 2 == 0 ? 0 : std::abs(uniform(random)) / 2;
  for (int i = 0; i < 3; ++i) {
    c.b[i] = c.a[i] + s * (c.a[3 + i] - c.a[i]) + t * (c.a[6 + i] - c.a[i]);
    if (t == 0) c.b[3 + i] = c.b[i] + (c.b[i] - c.b[6 + i]) * 0.5f;
  }
  return c;
}

Coordinates shared_vertex_pair(Random& random) {
  Coordinates c = uniform_pair(random);
  std::copy(&c.a[3], &c.a[6], &c.b[6]);
  return c;
}

struct Kind {
  const char* name;
  Coordinates (*draw)(Random&);
};
constexpr Kind kKinds[] = {{"uniform", uniform_pair}, {"lattice", lattice_pair}, {"wide", wide_pair},
                           {"extreme", extreme_pair}, {"near", near_pair},       {"shared_vertex", shared_vertex_pair}};

TEST(Filter, FindsNothingThatIsNotSo) {
  for (const Kind& kind : kKinds) {
    Random random(11);
    for (int i = 0; i < 20'000; ++i) {
      const Coordinates c = kind.draw(random);
      const Finding found = portable::filter(c.a, c.b);
      if (found == Finding::unsure) continue;
      const bool intersects = KindsFor<float>::All::visit(grid_of(c.a, c.b), [&](auto numbers) {
        return by_axes(triangles<decltype(numbers)>(c.a, c.b, grid_of(c.a, c.b).exponent)).intersects();
      });
      ASSERT_EQ(found, intersects ? Finding::crosses : Finding::disjoint) << kind.name << ' ' << i;
    }
  }
}

// Tests the same pairs as doubles, scaled to the limits of the bounds.
TEST(Filter, OfDoublesFindsNothingThatIsNotSo) {
  for (const Kind& kind : kKinds) {
    for (const int exponent : {0, -900, -300, 150, 299, 320, 890}) {
      Random random(13);
      int found_of[5] = {};
      for (int i = 0; i < 2'000; ++i) {
        const Coordinates c = kind.draw(random);
        double a[9], b[9];
        for (int k = 0; k < 9; ++k) {
          a[k] = std::ldexp(static_cast<double>(c.a[k]), exponent);
          b[k] = std::ldexp(static_cast<double>(c.b[k]), exponent);
        }
        if (i % 2 == 0) b[i / 2 % 9] = std::nextafter(b[i / 2 % 9], 0.0);
        const Finding found = portable::filter(a, b);
        ++found_of[static_cast<int>(found)];
#ifdef __SSE2__
        ASSERT_EQ(sse2::filter(a, b), found) << kind.name << ' ' << i;
#endif
        if (found == Finding::unsure) continue;
        const bool intersects = KindsFor<double>::All::visit(grid_of(a, b), [&](auto numbers) {
          return by_axes(triangles<decltype(numbers)>(a, b, grid_of(a, b).exponent)).intersects();
        });
        ASSERT_EQ(found, intersects ? Finding::crosses : Finding::disjoint) << kind.name << ' ' << i;
      }
      if (kind.draw != uniform_pair) continue;
      const bool certain = exponent > -300 && exponent < 300;
      EXPECT_EQ(found_of[static_cast<int>(Finding::unsure)], certain ? 0 : 2'000) << exponent;
    }
  }
}

#ifdef __SSE2__
TEST(Filter, IsTheSameWithAndWithoutSse2) {
  for (const Kind& kind : kKinds) {
    Random random(7);
    int count[5] = {};
    for (int i = 0; i < 200'000; ++i) {
      const Coordinates c = kind.draw(random);
      const Finding found = portable::filter(c.a, c.b);
      ASSERT_EQ(sse2::filter(c.a, c.b), found) << kind.name << ' ' << i;
      ++count[static_cast<int>(found)];
    }
    // The filter is always unsure about a shared vertex, and never about pairs in general position.
    const bool shared = kind.draw == shared_vertex_pair,
               general = kind.draw == uniform_pair || kind.draw == extreme_pair;
    EXPECT_EQ(count[static_cast<int>(Finding::crosses)] == 0, shared) << kind.name;
    EXPECT_EQ(count[static_cast<int>(Finding::disjoint)] == 0, shared) << kind.name;
    EXPECT_EQ(count[static_cast<int>(Finding::unsure)] == 0, general) << kind.name;
  }
}
#endif

}  // namespace
}  // namespace graze::exact::detail
