// SPDX-License-Identifier: Apache-2.0
#include "analysis/agreement.h"

#include <gtest/gtest.h>

#include "core/exact/exact.h"
#include "cuda/twin/twin.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

using strata::stratum_sources;

const Lane& lane(const char* id) { return *find_lane(id); }

AgreeSpec spec_of(const Lane& first, const Lane& second, std::uint64_t pairs, const std::vector<std::string>& globs) {
  AgreeSpec spec;
  spec.sweep = agreement_sweep(first, second);
  spec.sources = stratum_sources(5, pairs / 10, globs);
  spec.others = stratum_sources(6, pairs, globs);
  spec.sites = sites_asked(first, spec.sources);
  return spec;
}

TEST(Tolerance, MayBeSubnormal) { EXPECT_EQ(tolerance_of("plane_distance=abs:1e-320"), 1e-320); }

// Recounts with decide_one: without a policy, for ladders of tolerances, and for twins.
TEST(AgreementSweep, CountsWhatARecountCounts) {
  const auto sources = stratum_sources(3, 3001, {"near_vertex_face", "shared_edge", "extreme_scale"});
  const std::vector<std::string> policies = {"", "abs:1e-9", "abs:1e-6", "rel:1", "rel:100", "plane_distance=rel:8"};
  const Lane &first = lane("moller_1997/f32/cpu"), &second = lane("moller_1997/f32/cuda-fma");
  const std::vector<Agreement> found = agreement_sweep(first, second)(policies, sources);
  std::uint64_t mended = 0, added = 0;
  for (std::size_t p = 0; p < policies.size(); ++p) {
    const auto block = [&](const Lane& of) {
      return cuda::block_on_host(policies[p].empty() ? of : lane_under(of, policies[p]));
    };
    const DecideBlock zero[] = {first.decide, cuda::block_on_host(second)}, under[] = {block(first), block(second)};
    Agreement expected;
    expected.policy = policies[p];
    for (std::size_t s = 0; s < sources.size(); ++s) {
      for (std::uint64_t i = 0; i < sources[s].pairs; ++i) {
        const Pair pair = sources[s].pair(i);
        const Verdict truth = exact::intersects(&pair.a[0].x, &pair.b[0].x) ? Verdict::intersects : Verdict::disjoint;
        const Verdict before[] = {decide_one(zero[0], pair), decide_one(zero[1], pair)};
        const Verdict now[] = {decide_one(under[0], pair), decide_one(under[1], pair)};
        ++expected.pairs;
        expected.intersecting += truth == Verdict::intersects;
        expected.mended += before[0] != before[1] && now[0] == now[1];
        expected.added += before[0] == before[1] && now[0] != now[1];
        for (int l = 0; l < 2; ++l) {
          if (now[l] != truth) ++expected.of[l].of(now[l]);
        }
        if (now[0] != now[1] && expected.differing++ == 0) expected.first = PairPlace{static_cast<int>(s), i};
      }
    }
    EXPECT_EQ(found[p], expected) << policies[p];
    EXPECT_EQ(found[p].differing, found[0].differing - found[p].mended + found[p].added) << policies[p];
    mended += found[p].mended;
    added += found[p].added;
  }
  EXPECT_GT(found[0].differing, 20u);
  EXPECT_GT(mended, 20u);
  EXPECT_GT(added, 20u);
  for (const int threads : {1, 3}) EXPECT_EQ(agreement_sweep(first, second, threads)(policies, sources), found);
}

TEST(Agree, ALaneAgreesWithItselfWithoutAPolicy) {
  const Lane& moller = lane("moller_1997/f32/cpu");
  AgreeSpec spec = spec_of(moller, moller, 5000, {"near_*"});
  spec.max_rate = 1e-3;
  const Agreed agreed = agree(spec);
  EXPECT_EQ(agreed.chosen, "");
  EXPECT_EQ(agreed.result, TuneResult::satisfied);
  EXPECT_EQ(agreed.confirmed.pairs, 5000u);
  EXPECT_EQ(agreed.confirmed.differing, 0u);
  EXPECT_GT(agreed.confirmed.of[0].wrong(), 100u);  // lanes that agree can both be wrong
  EXPECT_EQ(agreed.confirmed.of[0], agreed.confirmed.of[1]);
}

TEST(Agree, WithoutContractionNoPolicyIsNeeded) {
  std::uint64_t contracted = 0;
  for (const char* subject : {"moller_1997/f32", "interval_overlap/f32", "guigue_devillers_2003/f64"}) {
    const Lane &cpu = lane((std::string(subject) + "/cpu").c_str()),
               &nofma = lane((std::string(subject) + "/cuda-nofma").c_str());
    AgreeSpec spec = spec_of(cpu, nofma, 4000, {"near_*", "coplanar_*", "extreme_scale"});
    spec.sites.clear();
    spec.max_rate = 1e-3;
    const Agreed agreed = agree(spec);
    EXPECT_EQ(agreed.chosen, "") << subject;
    EXPECT_EQ(agreed.result, TuneResult::satisfied) << subject;
    EXPECT_EQ(agreed.confirmed.differing, 0u) << subject;
    const Lane& fma = lane((std::string(subject) + "/cuda-fma").c_str());
    contracted += agreement_sweep(cpu, fma)(std::vector<std::string>{""}, spec.others).front().differing;
  }
  EXPECT_GT(contracted, 100u);
}

// Checks that agree() made the choice that its comment describes, and that its bounds hold on pairs of another seed.
void expect_true(const AgreeSpec& spec, const Agreed& agreed, const std::vector<std::string>& globs) {
  const Agreement chosen = spec.sweep(std::vector<std::string>{agreed.chosen}, spec.sources).front();
  const auto clearly = [&](const Agreement& a) {
    return a.differing == 0 || upper_bound(a.differing, a.pairs) <= spec.max_rate / 2;
  };
  EXPECT_FALSE(is_blunt(chosen, agreed.zero)) << agreed.chosen;
  EXPECT_EQ(agreed.picks.size(), agreed.curves.size());
  const auto curve_of = [](const std::string& policy) { return policy.substr(0, policy.rfind(':')); };
  bool any = clearly(agreed.zero);
  for (const CurveOf<Agreement>& curve : agreed.curves) {
    for (const Agreement& point : curve.points) {
      if (is_blunt(point, agreed.zero)) continue;
      any = any || clearly(point);
      if (!clearly(chosen)) {
        EXPECT_GE(point.differing, chosen.differing) << point.policy;
      } else if (curve_of(point.policy) == curve_of(chosen.policy)) {
        EXPECT_FALSE(clearly(point) && tolerance_of(point.policy) < tolerance_of(chosen.policy))
            << point.policy << " is smaller than " << agreed.chosen << " and makes them agree";
      }
    }
  }
  EXPECT_EQ(clearly(chosen), any);
  const Agreement fresh =
      spec.sweep(std::vector<std::string>{agreed.chosen}, stratum_sources(77, 20'000, globs)).front();
  EXPECT_LE(lower_bound(fresh.differing, fresh.pairs), agreed.high) << agreed.chosen;
  EXPECT_GE(upper_bound(fresh.differing, fresh.pairs), agreed.low) << agreed.chosen;
}

TEST(Agree, AToleranceMakesTwoLanesAgree) {
  AgreeSpec spec = spec_of(lane("moller_1997/f32/cpu"), lane("moller_1997/f32/cuda-fma"), 30'000, {"shared_edge"});
  spec.max_rate = 5e-3;
  const Agreed agreed = agree(spec);
  EXPECT_EQ(agreed.result, TuneResult::satisfied) << agreed.chosen << " " << agreed.confirmed.differing;
  EXPECT_GT(tolerance_of(agreed.chosen), 0x1p-10);  // the tolerance is not too small to matter
  EXPECT_GT(agreed.zero_confirmed.differing, 1000u);
  EXPECT_GT(agreed.confirmed.differing, 0u);
  EXPECT_LE(agreed.high, 5e-3);
  expect_true(spec, agreed, {"shared_edge"});
}

TEST(Agree, NoToleranceSuffices) {
  const Lane &cpu = lane("interval_overlap/f32/cpu"), &fma = lane("interval_overlap/f32/cuda-fma");
  AgreeSpec spec = spec_of(cpu, fma, 20'000, {});
  spec.relative = false;
  spec.rounded = agreement_sweep(cpu, lane("interval_overlap/f32/cuda-nofma"));
  spec.max_rate = 1e-3;
  const Agreed agreed = agree(spec);
  EXPECT_EQ(agreed.result, TuneResult::not_satisfiable) << agreed.chosen << " " << agreed.confirmed.differing;
  EXPECT_GT(agreed.low, 1e-3);
  EXPECT_LT(agreed.confirmed.differing, agreed.zero_confirmed.differing);
  EXPECT_GT(agreed.confirmed.added, 0u);
  ASSERT_TRUE(agreed.rounded);
  EXPECT_EQ(agreed.rounded->differing, 0u);
  EXPECT_EQ(agreed.rounded->pairs, 20'000u);
  EXPECT_EQ(agreed.curves.size(), 4u);
  for (const CurveOf<Agreement>& curve : agreed.curves) EXPECT_FALSE(curve.relative);
  expect_true(spec, agreed, {});
}

// A tolerance under which both lanes always give the same answer must not count as agreement.
TEST(Agree, ABluntToleranceIsNotChosen) {
  Agreement zero, under;
  zero.pairs = under.pairs = 100;
  zero.intersecting = under.intersecting = 30;
  zero.of[0].false_negative = zero.of[1].false_negative = 5;
  EXPECT_FALSE(is_blunt(zero, zero));
  under.of[1].false_positive = 29;
  EXPECT_FALSE(is_blunt(under, zero));
  under.of[1].false_positive = 30;
  EXPECT_TRUE(is_blunt(under, zero));
  zero.of[1].false_negative = 30;  // not worse than without the tolerance
  EXPECT_FALSE(is_blunt(under, zero));
}

// If only a blunt tolerance makes the lanes agree, it is reported, and the best of the other tolerances is chosen.
TEST(Agree, NamesABluntToleranceThatAloneWouldDo) {
  AgreeSpec spec;
  spec.sources = stratum_sources(5, 1000, {"uniform"});
  spec.others = stratum_sources(6, 1000, {"uniform"});
  spec.sites = {"plane_distance"};
  spec.max_rate = 1e-2;
  spec.sweep = [](Policies policies, Sources) {
    std::vector<Agreement> result;
    for (const std::string& policy : policies) {
      Agreement& of = result.emplace_back();
      of.policy = policy;
      of.pairs = 1000;
      of.intersecting = 400;
      const double tolerance = policy.empty() ? 0 : tolerance_of(policy);
      const bool large = policy.starts_with("abs") && tolerance >= 8;
      of.differing = large ? 0 : policy.starts_with("plane_distance=rel") && tolerance >= 2 ? 50 : 60;
      of.of[0].false_positive = large ? 400 : 5;
      of.of[1].false_positive = large ? 300 : 5;
    }
    return result;
  };
  const Agreed agreed = agree(spec);
  EXPECT_EQ(agreed.result, TuneResult::not_satisfiable);
  EXPECT_EQ(agreed.chosen, "plane_distance=rel:2");
  ASSERT_TRUE(agreed.blunt);
  EXPECT_EQ(agreed.blunt->policy, "abs:8");
  EXPECT_EQ(agreed.blunt->of[0].false_positive, 400u);
}

TEST(Agree, TheResultNeedsPairsEnough) {
  const auto with = [](std::uint64_t differing, std::uint64_t pairs) {
    Agreement result;
    result.differing = differing;
    result.pairs = pairs;
    return result;
  };
  EXPECT_EQ(agreement_result(with(0, 100), with(0, 2995), 1e-3), TuneResult::satisfied);
  EXPECT_EQ(agreement_result(with(0, 100), with(0, 2994), 1e-3), TuneResult::too_few_pairs);
  EXPECT_EQ(agreement_result(with(1, 100), with(3, 1000), 1e-3), TuneResult::too_few_pairs);  // rate >= 0.0008
  EXPECT_EQ(agreement_result(with(1, 100), with(4, 1000), 1e-3), TuneResult::not_satisfiable);
  EXPECT_EQ(agreement_result(with(0, 100), with(4, 1000), 1e-3), TuneResult::not_confirmed);
}

}  // namespace
}  // namespace graze::analysis
