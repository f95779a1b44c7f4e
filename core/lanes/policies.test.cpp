// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/policies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/algorithms/algorithms.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/lanes/with_error_bound.h"

namespace graze {
namespace {

const Lane& lane(const std::string& id) {
  add_policy_lanes(id);
  const Lane* found = find_lane(id);
  if (!found) throw std::runtime_error(id + ": expected a lane");
  return *found;
}

std::string refusal(const std::string& id) {
  try {
    add_policy_lanes(id);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

Pair scaled(Pair pair, float scale) {
  for (int c = 0; c < kCoordinates; ++c) coordinates(pair)[c] *= scale;
  return pair;
}

// Two parallel triangles of size `scale`, half their size apart.
Pair apart(float scale) {
  return scaled({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0.5f}, {1, 0, 0.5f}, {0, 1, 0.5f}}}, scale);
}

// b stands upright above a. The lowest vertex of b is above a's interior, at a height of 2^-k * scale.
Pair above(int k, float scale) {
  const float gap = std::ldexp(1.0f, -k);
  return scaled({{{0, 0, 0}, {3, 0, 1}, {0, 3, 1}}, {{0.75f, 0.75f, 0.5f + gap}, {1, 2, 4}, {2, 1, 4}}}, scale);
}

TEST(Policies, OfMollersPaperBreakBelowTheScaleItWasMadeFor) {
  const Lane& paper = lane("moller_1997/f32/cpu/paper");
  // Plane distances are half the size times the normal's length (size squared): s^3 / 2 < 1e-6 for s below 0.0126.
  EXPECT_EQ(decide_one(paper.decide, apart(0.0127f)), Verdict::disjoint);
  EXPECT_EQ(decide_one(paper.decide, apart(0.0125f)), Verdict::intersects);
  EXPECT_EQ(decide_one(find_lane("moller_1997/f32/cpu")->decide, apart(0.0125f)), Verdict::disjoint);
  EXPECT_EQ(decide_one(lane("moller_1997/f32/cpu/plane_distance=abs:1e-6").decide, apart(0.0125f)),
            Verdict::intersects);
  EXPECT_EQ(decide_one(lane("moller_1997/f32/cpu/separation=abs:1e-6").decide, apart(0.0125f)), Verdict::disjoint);
  EXPECT_EQ(decide_one(lane("moller_1997/f64/cpu/rel:64").decide, apart(0.0125f)), Verdict::disjoint);
}

TEST(Policies, RelativeOnesDoNotKnowTheScale) {
  for (const char* algorithm : {"projected_sat", "moller_1997", "guigue_devillers_2003", "separating_axes"}) {
    const Lane &loose = lane(std::string(algorithm) + "/f64/cpu/rel:1e12"),
               &zero = *find_lane(std::string(algorithm) + "/f64/cpu");
    int changed = 0;
    for (int k = 1; k < 22; ++k) {
      const Verdict verdict = decide_one(loose.decide, above(k, 1));
      changed += verdict != decide_one(zero.decide, above(k, 1));
      for (const int scale : {-18, -9, 7, 20})
        EXPECT_EQ(decide_one(loose.decide, above(k, std::ldexp(1.0f, scale))), verdict)
            << loose.id << " " << k << " " << scale;
    }
    EXPECT_GT(changed, 2) << loose.id;
    EXPECT_LT(changed, 21) << loose.id;
  }
}

TEST(Policies, OfNothingAreZero) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> small(-3, 3);
  for (const Lane& row : published_lanes()) {
    if (!runs_on_this_cpu(row) || row.variant != Variant::cpu) continue;
    const Lane &absolute = lane(row.id + "/abs:0"), &relative = lane(row.id + "/plane_distance=rel:0,separation=abs:0");
    for (int i = 0; i < 2000; ++i) {
      Pair pair{};
      for (int c = 0; c < kCoordinates; ++c)
        coordinates(pair)[c] = static_cast<float>(small(random)) * (i % 2 ? 0.3f : 1);
      if (i % 100 == 7) coordinates(pair)[i % kCoordinates] = i % 3 ? INFINITY : NAN;
      ASSERT_EQ(decide_one(absolute.decide, pair), decide_one(row.decide, pair)) << row.id << " " << i;
      ASSERT_EQ(decide_one(relative.decide, pair), decide_one(row.decide, pair)) << row.id << " " << i;
    }
  }
}

TEST(Policies, AddLanesOnceForEachThatMatches) {
  const std::size_t before = lanes().size();
  add_policy_lanes("*/f32/cpu/rel:7");
  EXPECT_EQ(lanes().size(), before + kAlgorithmCount);
  add_policy_lanes("*/f32/cpu/rel:7");
  EXPECT_EQ(lanes().size(), before + kAlgorithmCount);
  const std::size_t without_stars = lanes().size();
  add_policy_lanes("*/cpu/rel:7");  // a star may stand for several parts, so this includes the f64 lanes
  EXPECT_EQ(lanes().size(), without_stars + kAlgorithmCount);
  add_policy_lanes("*/cpu");
  add_policy_lanes("*/nothing");
  EXPECT_EQ(lanes().size(), without_stars + kAlgorithmCount);
  const Lane& added = *find_lane("separating_axes/f32/cpu/rel:7");
  EXPECT_EQ(added.policy, "rel:7");
  EXPECT_EQ(added.under->epsilons.relative[static_cast<int>(Site::separation)], 7);
  EXPECT_FALSE(added.exact);
  // Four of the five algorithms have the policy `bound`.
  add_policy_lanes("*/f64/cpu-fma/bound");
  EXPECT_NE(find_lane("moller_1997/f64/cpu-fma/bound"), nullptr);
  EXPECT_EQ(find_lane("projected_sat/f64/cpu-fma/bound"), nullptr);
}

TEST(Policies, OfOneWordMayFollowAStarForSeveralParts) {
  for (const std::string_view policy : kNamedPolicies) {
    add_policy_lanes("moller*/cpu/" + std::string(policy));
    EXPECT_NE(find_lane("moller_1997/f64/cpu/" + std::string(policy)), nullptr) << policy;
  }
}

// A site's tolerance is the sum of its absolute and its relative tolerance, so both are kept.
TEST(Policies, OfOneSiteMayBeAbsoluteAndRelative) {
  const Epsilons& both = lane("moller_1997/f32/cpu/plane_distance=abs:3,plane_distance=rel:5").under->epsilons;
  EXPECT_EQ(both.absolute[static_cast<int>(Site::plane_distance)], 3);
  EXPECT_EQ(both.relative[static_cast<int>(Site::plane_distance)], 5);
}

// Pairs of doubles near contact: b's first vertex is off a's plane only in the last bits.
std::vector<DoublePair> near_contacts() {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<DoublePair> pairs(3000);
  for (DoublePair& pair : pairs) {
    for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = number(random);
    const double s = 0.3, t = 0.25;
    const Vec3<double> u = pair.a[1] - pair.a[0], v = pair.a[2] - pair.a[0];
    pair.b[0] = {pair.a[0].x + s * u.x + t * v.x, pair.a[0].y + s * u.y + t * v.y, pair.a[0].z + s * u.z + t * v.z};
  }
  return pairs;
}

template <class Algorithm>
void expect_lane_of_doubles(const std::vector<DoublePair>& pairs) {
  const Lane& lane = *find_lane(std::string(Algorithm::kInfo.id) + "/f64/cpu");
  ASSERT_TRUE(lane.decide.decides_doubles());
  for (const DoublePair& pair : pairs) {
    const Verdict expected = Algorithm::decide(pair.a, pair.b);
    ASSERT_EQ(decide_one(lane.decide, pair), expected) << lane.id;
  }
}

TEST(LanesInDouble, DecideDoublesAsTheirAlgorithmDoes) {
  const std::vector<DoublePair> pairs = near_contacts();
  [&]<class... Algorithm>(const std::tuple<Algorithm...>*) {
    (expect_lane_of_doubles<Algorithm>(pairs), ...);
  }(static_cast<const Algorithms*>(nullptr));
}

// A lane's functions for floats and for doubles agree on doubles that float32 holds, under every kind of policy.
TEST(LanesInDouble, AgreeWithThemselvesOnFloat32) {
  std::size_t lanes_seen = 0;
  for (const char* policy : {"", "abs:1e-9", "rel:8", "bound", "filtered"}) {
    if (*policy) add_policy_lanes("*/f64/cpu*/" + std::string(policy));
  }
  for (const Lane& lane : lanes()) {
    // With fast math, a function's code depends on what else is compiled with it.
    if (lane.scalar != Scalar::f64 || !lane.decide || info_of(lane.variant).arithmetic == Arithmetic::fast) continue;
    if (!runs_on_this_cpu(lane)) continue;
    ASSERT_TRUE(lane.decide.decides_doubles()) << lane.id;
    ++lanes_seen;
    for (const DoublePair& pair : near_contacts()) {
      const Pair stored = stored_in_float32(pair);
      ASSERT_EQ(decide_one(lane.decide, in_doubles(stored)), decide_one(lane.decide, stored)) << lane.id;
    }
  }
  EXPECT_GT(lanes_seen, 5u * 2 * 3);
}

TEST(Policies, RefuseWhatTheyDoNotKnow) {
  EXPECT_EQ(refusal("moller_1997/f32/cpu"), "accepted");
  EXPECT_EQ(refusal("nothing/f32/cpu/rel:1"), "accepted");  // no such lane; the code that selects lanes reports it
  const std::string forms = "expected a policy (zero, abs:E, rel:K, SITE=abs:E,…, paper, bound or filtered), found ";
  EXPECT_EQ(refusal("moller_1997/f32/cpu/eps"), forms + "\"eps\"");
  EXPECT_EQ(refusal("moller_1997/f32/cpu/abs:-1"), forms + "\"abs:-1\": \"-1\" is not a number of at least 0");
  EXPECT_EQ(refusal("moller_1997/f32/cpu/rel:nan"), forms + "\"rel:nan\": \"nan\" is not a number of at least 0");
  EXPECT_EQ(refusal("moller_1997/f32/cpu/plane=abs:1"),
            forms + "\"plane=abs:1\": the sites are plane_distance, parallel, orientation, separation");
  EXPECT_EQ(refusal("moller_1997/f32/cpu/parallel=abs:1,parallel=abs:2"),
            forms + "\"parallel=abs:1,parallel=abs:2\": it gives parallel=abs twice; leave one out");
  EXPECT_EQ(refusal("separating_axes/f32/cpu/paper"),
            forms + "\"paper\": the paper of separating_axes compares with zero, like the lane without a policy");
  EXPECT_EQ(refusal("projected_sat/f32/cpu/bound"),
            forms + "\"bound\": projected_sat is wrong on some pairs even without rounding, so no bound helps");
  EXPECT_EQ(refusal("moller_1997/f32/cpu-fast/bound"),
            "expected a policy other than bound for moller_1997/f32/cpu-fast: fast math invalidates error bounds");
}

TEST(WithErrorBound, KnowsWhatIsExact) {
  using B = WithErrorBound<float>;
  bool doubt = false;
  const B x(1.5f, &doubt), y(1.5f, &doubt), z(0.1f, &doubt);
  EXPECT_TRUE((x - y).is_exact_zero());
  EXPECT_TRUE(((x - y) * z).is_exact_zero());
  EXPECT_TRUE(((x - y) * z + (y - x)).is_exact_zero());
  EXPECT_TRUE(((x - y) / z).is_exact_zero());
  EXPECT_FALSE((x * z - z * x).is_exact());
  EXPECT_TRUE(x > B(0));
  EXPECT_FALSE(doubt);
  EXPECT_FALSE(x * z - z * x > B(0));
  EXPECT_TRUE(doubt);
  doubt = false;
  const B tiny(0x1p-149f, &doubt), large(0x1p127f, &doubt);
  EXPECT_EQ((tiny * tiny).value, 0);
  EXPECT_FALSE(tiny * tiny > B(0));  // the exact product is positive, but the computed one underflowed
  EXPECT_TRUE(doubt);
  doubt = false;
  EXPECT_TRUE(large * large > B(0));
  EXPECT_TRUE(doubt);  // an infinite bound decides nothing
}

// Random expressions, compared with their values in long double, which is precise enough for them.
TEST(WithErrorBound, HoldsTheExactQuantity) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<float> mantissa(-2, 2);
  std::uniform_int_distribution<int> exponent(-40, 40), operation(0, 4);
  int held = 0, tight = 0;
  for (int i = 0; i < 300000; ++i) {
    bool doubt = false;
    WithErrorBound<float> x(std::ldexp(mantissa(random), exponent(random) / (i % 2 ? 1 : 20)), &doubt);
    long double exact = x.value;
    for (int step = 0; step < 4; ++step) {
      const WithErrorBound<float> y(std::ldexp(mantissa(random), exponent(random) / (i % 2 ? 1 : 20)), &doubt);
      switch (operation(random)) {
        case 0:
          x = x + y, exact += y.value;
          break;
        case 1:
          x = y - x, exact = y.value - exact;
          break;
        case 2:
          x = x * y, exact *= y.value;
          break;
        case 3:
          x = y / x, exact = y.value / exact;
          break;
        default:
          x = sqrt(x * x), exact = std::fabs(exact);
      }
    }
    if (!std::isfinite(x.error) || !std::isfinite(x.value)) continue;
    ++held;
    const long double off = std::fabs(exact - x.value);
    ASSERT_LE(off, x.error * (1 + 1e-15L)) << i;
    tight += off > x.error / 64;
  }
  EXPECT_GT(held, 200000);
  EXPECT_GT(tight, held / 4);  // a bound that is always huge would fail this
}

}  // namespace
}  // namespace graze
