// SPDX-License-Identifier: Apache-2.0
// Tests each cause on a pair made for it, and invariants of explanations over all strata.
#include "analysis/explain.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "backends/backends.h"
#include "core/relation_of.h"
#include "corpus/pair_format.h"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

std::vector<const Lane*> lanes_here() {
  std::vector<const Lane*> result;
  for (const Lane& lane : published_lanes()) {
    if (lane.is_cuda() ? cuda::twin_row(lane).decide != nullptr : runs_on_this_cpu(lane)) result.push_back(&lane);
  }
  return result;
}

const LaneExplanation& lane_of(const Explanation& explanation, std::string_view id) {
  for (const LaneExplanation& lane : explanation.lanes) {
    if (lane.lane->id == id) return lane;
  }
  throw std::runtime_error(std::string(id) + " is not wrong");
}

// A replay has the lane's own values: without contraction by construction, for CUDA by the hash of the values. For
// contraction on the host, only the verdict can be compared.
TEST(Replay, IsTheLanesOwnRun) {
  for (const Lane* lane : lanes_here()) {
    int pairs = 0, known = 0;
    for (const strata::StratumInfo& stratum : strata::kStrata) {
      for (std::uint64_t i = 0; i < 400; ++i, ++pairs) {
        const Pair pair = strata::generate(7, stratum.stratum, i);
        const Replay run = replay(*lane, pair);
        if (!lane->explainable) {
          ASSERT_EQ(run.evidence, Evidence::none) << lane->id;
          continue;
        }
        known += run.evidence != Evidence::none && run.run.verdict == decide_lane(*lane, pair);
        if (lane->variant == Variant::cuda_fma) {
          EXPECT_NE(run.evidence, Evidence::source);
          known -= run.evidence == Evidence::verdict;
        }
      }
    }
    if (!lane->explainable) continue;
    const bool by_rule = info_of(lane->variant).arithmetic == Arithmetic::contracted;
    EXPECT_GE(known, by_rule ? pairs - pairs / (lane->is_cuda() ? 1000 : 50) : pairs) << lane->id;
  }
}

// A run that is led along its own path repeats itself; along another path, it does not.
TEST(Replay, CanBeLed) {
  const Lane& lane = *find_lane("projected_sat/f32/cpu");
  const Pair pair = strata::generate(7, strata::Stratum::near_edge_edge, 3);
  const Trace<double> run = run_led(lane, pair, Contraction::none, {});
  EXPECT_EQ(path_of(run_led(lane, pair, Contraction::none, path_of(run))), path_of(run));
  Path astray = path_of(run);
  ASSERT_GT(astray.size(), 3u);
  astray.resize(3);
  astray[2] = !astray[2];
  const Trace<double> other = run_led(lane, pair, Contraction::none, astray);
  EXPECT_NE(path_of(other), path_of(run));
  int comparisons = 0;
  for (const Seen<double>& seen : other.seen) {
    if (!seen.compared) continue;
    ++comparisons;
    EXPECT_EQ(seen.taken == seen.held, comparisons != 3);
  }
}

Pair scaled(Pair pair, float factor) {
  for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] *= factor;
  return pair;
}

// A vertex is 2^-12 above the face.
const Pair kNearContact{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0x1p-12f}, {1, 2, 4}, {2, 1, 4}}};

TEST(Explain, AlgorithmsThatAreWrongExactlyAreSoByLogic) {
  Pair figure{};
  for (const corpus::Entry& entry : corpus::read_pairs(GRAZE_SOURCE_DIR "/corpus/classic/thesis_2012.pairs")) {
    if (*field(entry, "name") == "thesis_2012_figure_3_4") figure = entry.pair;
  }
  const Explanation explanation = explain(figure, lanes_here());
  ASSERT_GE(explanation.lanes.size(), 2u);
  for (const LaneExplanation& lane : explanation.lanes) {
    EXPECT_EQ(lane.lane->info->id, "projected_sat");
    EXPECT_EQ(name(lane.cause), "logic") << lane.lane->id;
    EXPECT_EQ(lane.bits_needed, 0);
    EXPECT_EQ(lane.orders.of, 72);
    EXPECT_EQ(lane.mirrored.wrong, 8);
  }
  EXPECT_NE(sentence(explanation, explanation.lanes[0].lane->info).find("the algorithm itself is wrong"),
            std::string::npos)
      << sentence(explanation, explanation.lanes[0].lane->info);
}

TEST(Explain, ANearContactAtATinyScaleUnderflows) {
  EXPECT_TRUE(explain(kNearContact, lanes_here()).lanes.empty());
  const Explanation explanation = explain(scaled(kNearContact, 1e-30f), lanes_here());
  const LaneExplanation& lane = lane_of(explanation, "guigue_devillers_2003/f32/cpu");
  EXPECT_EQ(name(lane.cause), "underflow");
  EXPECT_EQ(name(lane_of(explanation, "separating_axes/f32/cuda-fma").cause), "underflow");
  ASSERT_NE(lane.told(), nullptr);
  EXPECT_EQ(lane.told()->left.lane, 0);
  EXPECT_GT(lane.told()->left.exact, 0);
  EXPECT_EQ(lane.bits_needed, 24);
  EXPECT_GT(lane.scalings.wrong, 0);
  EXPECT_LT(lane.scalings.wrong, lane.scalings.of);
}

TEST(Explain, AtAHugeScaleItOverflows) {
  const Explanation explanation = explain(scaled(kNearContact, 1e30f), lanes_here());
  const LaneExplanation& lane = lane_of(explanation, "moller_1997/f32/cpu");
  EXPECT_EQ(name(lane.cause), "overflow");
  ASSERT_NE(lane.told(), nullptr);
  EXPECT_FALSE(std::isfinite(lane.told()->left.lane));
}

// Even without exponent limits, 24 bits would not be enough here. The comparison's operand is NaN, however, so the
// exponent limit is the cause.
TEST(Explain, ARangeThatIsNotAllThatLacksIsStillTheCause) {
  const Pair pair = strata::generate(1, strata::Stratum::extreme_scale, 2280);
  const Explanation explanation = explain(pair, lanes_here());
  const LaneExplanation& lane = lane_of(explanation, "interval_overlap/f32/cpu");
  EXPECT_EQ(oracle::decide_limited(lane.lane->algorithm, Scalar::f32, in_doubles(pair), {false, false}).verdict,
            lane.verdict);
  EXPECT_EQ(name(lane.cause), "overflow");
  EXPECT_GT(lane.bits_needed, 24);
  ASSERT_NE(lane.told(), nullptr);
  EXPECT_TRUE(std::isnan(lane.told()->left.lane));
}

// Some products of 26 bits are too large for float32's exponents here.
TEST(Explain, BitsThatAreEnoughOnlyWithMoreExponentsAreSaidSo) {
  const Pair pair{{{-0x1.cf1f2p+22f, -0x1.d99f58p+21f, 0x1.1e02fcp+22f},
                   {-0x1.c5de2cp+22f, -0x1.c72788p+21f, 0x1.13d54p+22f},
                   {-0x1.cc06ecp+22f, -0x1.ccb798p+21f, 0x1.18a818p+22f}},
                  {{-0x1.cb6cccp+22f, -0x1.cd4138p+21f, 0x1.167268p+22f},
                   {-0x1.c8b54cp+22f, -0x1.c95bf8p+21f, 0x1.16a304p+22f},
                   {-0x1.c58768p+22f, -0x1.bec89p+21f, 0x1.18e838p+22f}}};
  const Explanation explanation = explain(pair, lanes_here());
  const LaneExplanation& lane = lane_of(explanation, "interval_overlap/f32/cpu");
  EXPECT_EQ(name(lane.cause), "rounding");
  EXPECT_EQ(lane.bits_needed, 26);
  EXPECT_FALSE(lane.bits_alone);
  const std::string text = sentence(explanation, lane.lane->info);
  EXPECT_NE(text.find("26 mantissa bits would be enough with unlimited exponents"), std::string::npos) << text;
}

// A lane whose cause differs is named with it, as a guess unless the cause is settled.
TEST(Explain, OtherCausesAreGuessesUnlessSettled) {
  Explanation explanation = explain(strata::generate(3, strata::Stratum::near_edge_edge, 100), lanes_here());
  const Lane* lane = find_lane("moller_1997/f32/cpu");
  std::erase_if(explanation.lanes, [&](const LaneExplanation& one) { return one.lane != lane; });
  ASSERT_EQ(explanation.lanes.size(), 1u);
  explanation.lanes.push_back(explanation.lanes[0]);
  explanation.lanes[1].lane = find_lane("moller_1997/f32/cpu-fast");
  explanation.lanes[1].cause = Cause::fast_math;
  for (const auto& [settled, words] :
       {std::pair(Settled::yes, "cpu-fast (fast math)"), std::pair(Settled::unknown, "cpu-fast (perhaps fast math)")}) {
    explanation.lanes[1].settled = settled;
    const std::string text = sentence(explanation, lane->info);
    EXPECT_NE(text.find(words), std::string::npos) << text;
  }
}

// Exact arithmetic divides by zero on the lane's path, so the compared numbers have no exact values.
TEST(Explain, NumbersThatExactArithmeticDoesNotDefineAreNotGivenExactly) {
  const Pair pair{{{0, 0, 0}, {0x1.a59p-3f, 0x1.ad0cep-2f, -0x1.fb2cp+0f}, {0x1.96b08p+0f, 0, -0x1.5a92p+1f}},
                  {{0x1.a0252p+2f, -0x1.776b44p+1f, 0x1.52p-2f},
                   {-0x1.a59p-3f, -0x1.ad0cep-2f, 0x1.fb2cp+0f},
                   {-0x1.96b08p+0f, 0, 0x1.5a92p+1f}}};
  const Explanation explanation = explain(pair, lanes_here());
  const LaneExplanation& lane = lane_of(explanation, "interval_overlap/f32/cpu");
  ASSERT_NE(lane.told(), nullptr);
  EXPECT_TRUE(std::isnan(lane.told()->left.exact) || std::isnan(lane.told()->right.exact));
  const std::string text = sentence(explanation, lane.lane->info);
  EXPECT_NE(text.find("a division by exactly zero, after which no number is defined"), std::string::npos) << text;
  EXPECT_NE(text.find("goes another way"), std::string::npos) << text;
  EXPECT_EQ(text.find("exactly NaN"), std::string::npos) << text;
}

TEST(Explain, WhatMoreBitsWouldHelpIsRounding) {
  const Explanation explanation = explain(strata::generate(3, strata::Stratum::near_edge_edge, 100), lanes_here());
  const LaneExplanation& lane = lane_of(explanation, "moller_1997/f32/cpu");
  EXPECT_EQ(name(lane.cause), "rounding");
  EXPECT_GT(lane.bits_needed, 24);
  EXPECT_LE(lane.bits_needed, 53);
  ASSERT_GE(lane.decisive, 0);
  const Step& step = lane.steps[static_cast<std::size_t>(lane.decisive)];
  EXPECT_TRUE(step.wrong());
  EXPECT_TRUE(step.line.starts_with("core/algorithms/moller_1997.h:")) << step.line;
  EXPECT_EQ(step.site, "separation");
  EXPECT_NE(sentence(explanation, lane.lane->info).find(": rounding turns the gap between two interval ends"),
            std::string::npos);
}

// On near-coplanar pairs on which cuda-fma and cuda-nofma differ, the blamed sites cause the difference, and no smaller
// set of sites does.
TEST(Explain, FlipsByContractionAreBlamedOnSourceLines) {
  int flips = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Pair pair = strata::generate(5, strata::Stratum::coplanar_rounded, i);
    for (const LaneExplanation& lane : explain(pair, lanes_here()).lanes) {
      const Lane& plain = *counterpart(*lane.lane, rounded_variant(lane.lane->variant));
      if (lane.lane->variant != Variant::cuda_fma || decide_lane(plain, pair) == lane.verdict) continue;
      ++flips;
      EXPECT_TRUE(lane.cause == Cause::contraction || lane.cause == Cause::logic) << lane.lane->id;
      const std::span<const cuda::ContractionSite> all = cuda::contraction_sites(*lane.lane);
      std::vector<std::size_t> blamed;
      for (std::size_t s = 0; s < all.size(); ++s) {
        for (const cuda::ContractionSite& site : lane.contractions.sites) {
          if (site.ptx_line == all[s].ptx_line) blamed.push_back(s);
        }
      }
      ASSERT_EQ(blamed.size(), lane.contractions.sites.size());
      ASSERT_FALSE(blamed.empty());
      const auto verdict_without = [&](std::size_t spared) {
        std::vector<std::uint64_t> fused(all.size() / 64 + 1);
        for (std::size_t s : blamed) fused[s / 64] |= std::uint64_t{s != spared} << (s % 64);
        return cuda::decide_fusing(*lane.lane, pair, fused);
      };
      EXPECT_EQ(verdict_without(all.size()), lane.verdict);
      // Either each site is necessary, or only rounding all sites undoes the effect.
      const bool needed =
          std::all_of(blamed.begin(), blamed.end(), [&](std::size_t s) { return verdict_without(s) != lane.verdict; });
      EXPECT_TRUE(needed || lane.settled == Settled::yes || lane.cause == Cause::logic) << lane.lane->id << i;
      for (const cuda::ContractionSite& site : lane.contractions.sites) {
        EXPECT_EQ(std::string_view(site.at.file).substr(0, 5), "core/");
        EXPECT_GT(site.at.line, 0);
      }
    }
  }
  EXPECT_GT(flips, 20);
}

TEST(Explain, ASentenceTellsOfACoplanarFlip) {
  std::vector<const Lane*> cuda;
  for (const Lane* lane : lanes_here()) {
    if (lane->is_cuda()) cuda.push_back(lane);
  }
  const Explanation explanation = explain(strata::generate(1, strata::Stratum::coplanar_rounded, 10), cuda);
  const std::string text = sentence(explanation, lane_of(explanation, "guigue_devillers_2003/f32/cuda-fma").lane->info);
  for (const char* part :
       {"guigue_devillers_2003/f32 (cuda-fma) says disjoint, but the triangles meet in a segment, 1.23e-09 deep: "
        "nvcc fuses the product into the addition at core/vec3.h:",
        "which turns an orientation of exactly -4.64625e-18 into ",
        "so that the comparison at core/algorithms/guigue_devillers_2003.h:140 goes the wrong way; "
        "without contraction it is right."})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

// Every wrong lane has a cause and, unless the cause is logic, a wrong comparison.
TEST(Explain, EveryWrongLaneHasItsAccount) {
  std::set<Cause> causes;
  int wrong = 0, decisive = 0, many = 0, unknown = 0;
  for (const strata::StratumInfo& stratum : strata::kStrata) {
    for (std::uint64_t i = 0; i < 12; ++i) {
      const Pair pair = strata::generate(9, stratum.stratum, i);
      const Explanation explanation = explain(pair, lanes_here());
      for (const LaneExplanation& lane : explanation.lanes) {
        ++wrong;
        causes.insert(lane.cause);
        EXPECT_NE(lane.verdict, explanation.truth.verdict);
        EXPECT_TRUE(lane.exactly.settled) << lane.lane->id << ' ' << stratum.id << ' ' << i;
        EXPECT_EQ(lane.exactly.verdict == explanation.truth.verdict, lane.cause != Cause::logic);
        EXPECT_GE(lane.orders.wrong, 1);
        EXPECT_GE(lane.mirrored.wrong, 1);
        EXPECT_GE(lane.scalings.wrong, 1);
        EXPECT_FALSE(sentence(explanation, lane.lane->info).empty());
        unknown += lane.evidence == Evidence::none && lane.lane->explainable;
        if (lane.cause == Cause::logic || lane.evidence == Evidence::none) continue;
        if (lane.settled == Settled::not_by_few) {
          EXPECT_EQ(lane.told(), nullptr);
          ++many;
          continue;
        }
        ASSERT_NE(lane.told(), nullptr) << lane.lane->id << ' ' << stratum.id << ' ' << i;
        EXPECT_TRUE(lane.told()->wrong());
        decisive += lane.then.empty();
      }
    }
  }
  EXPECT_GT(wrong, 500);
  EXPECT_GT(decisive, wrong / 3);
  EXPECT_LT(many, wrong / 100);
  EXPECT_LT(unknown, wrong / 50);
  EXPECT_GE(causes.size(), 4u);
}

TEST(Explain, TheSamePairGivesTheSameBytes) {
  for (const strata::Stratum stratum :
       {strata::Stratum::extreme_scale, strata::Stratum::coplanar_rounded, strata::Stratum::degenerate}) {
    for (std::uint64_t i = 0; i < 5; ++i) {
      const Pair pair = strata::generate(2, stratum, i);
      EXPECT_EQ(to_json(explain(pair, lanes_here())).dump(), to_json(explain(pair, lanes_here())).dump());
    }
  }
}

TEST(Explain, WithoutATruthThereIsNothingWrong) {
  Pair pair = kNearContact;
  pair.a[1].y = NAN;
  EXPECT_TRUE(explain(pair, lanes_here()).lanes.empty());
}

TEST(Neighbours, AreExactImages) {
  const Pair pair = strata::generate(1, strata::Stratum::uniform, 1);
  EXPECT_EQ(orders(pair).size(), 72u);
  EXPECT_EQ(mirrored(pair).size(), 8u);
  EXPECT_EQ(scalings(pair).size(), 2u * kMostScaling + 1);
  for (const std::vector<Pair>& images : {orders(pair), mirrored(pair), scalings(pair)}) {
    std::set<std::string> distinct;
    for (const Pair& image : images) {
      EXPECT_EQ(oracle::cgal_verdict(image), oracle::cgal_verdict(pair));
      distinct.emplace(reinterpret_cast<const char*>(&image), sizeof image);
    }
    EXPECT_EQ(distinct.size(), images.size());
  }
  Pair tiny = kNearContact;
  tiny.a[0].x = 0x1.8p-100f;
  EXPECT_LT(scalings(tiny).size(), 2u * kMostScaling + 1);
}

TEST(Neighbours, NudgesMoveOneCoordinateBothWays) {
  for (int c = 0; c < kCoordinates; ++c) {
    const std::vector<Pair> moved = nudged(kNearContact, c);
    ASSERT_EQ(moved.size(), 4u);
    for (const Pair& pair : moved) {
      for (int i = 0; i < kCoordinates; ++i)
        EXPECT_EQ(coordinates(pair)[i] != coordinates(kNearContact)[i], i == c) << c << ' ' << i;
    }
  }
}

// cause_of gives the cause that explain gives. If the processor raised no flag, MPFR finds no overflow or underflow
// either.
TEST(CauseOf, IsWhatExplainSays) {
  int wrong = 0, in_range = 0;
  std::set<Cause> seen;
  for (const strata::StratumInfo& stratum : strata::kStrata) {
    for (std::uint64_t i = 0; i < 12; ++i) {
      const Pair pair = strata::generate(11, stratum.stratum, i);
      const Explanation explanation = explain(pair, lanes_here());
      for (const LaneExplanation& lane : explanation.lanes) {
        ++wrong;
        seen.insert(lane.cause);
        EXPECT_EQ(cause_of(*lane.lane, pair, explanation.truth.verdict), lane.cause) << stratum.id << i;
        if (leaves_exponents(*lane.lane, pair)) continue;
        ++in_range;
        EXPECT_TRUE(lane.cause != Cause::overflow && lane.cause != Cause::underflow) << stratum.id << i;
        EXPECT_EQ(oracle::decide_limited(lane.lane->algorithm, lane.lane->scalar, in_doubles(pair), {true, true}).first,
                  oracle::RangeEvent::none);
      }
    }
  }
  EXPECT_EQ(seen.size(), 6u);
  EXPECT_GT(in_range, wrong / 3);
  EXPECT_LT(in_range, wrong);
}

// Lanes that can decide pairs of doubles: lanes in float32, which decide the stored pairs, and lanes in double that
// take doubles.
std::vector<const Lane*> lanes_of_doubles() {
  std::vector<const Lane*> result = lanes_here();
  std::erase_if(result, [](const Lane* lane) {
    return lane->scalar == Scalar::f64 && !backends::on_host(*lane).decides_doubles();
  });
  return result;
}

// An independent computation confirms each cause, over all strata of doubles.
TEST(ExplainDoubles, CausesAreTrue) {
  std::map<Cause, int> seen;
  int settled = 0, wrong = 0;
  const std::vector<const Lane*> lanes = lanes_of_doubles();
  for (const strata::PairSource& source : strata::stratum_sources(3, 28 * 12, {}, PairTypes::f64)) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) {
      const DoublePair pair = source.double_pair(i);
      if (!is_finite(pair)) continue;
      const Pair stored = stored_in_float32(pair);
      const Verdict truth = relation_of(pair).verdict, of_stored = relation_or_declined(stored).verdict;
      SCOPED_TRACE(source.id + ' ' + std::to_string(i));
      for (const LaneExplanation& lane : explain(pair, lanes).lanes) {
        ++wrong;
        ++seen[lane.cause];
        settled += lane.settled == Settled::yes;
        const bool f32 = lane.lane->scalar == Scalar::f32;
        EXPECT_EQ(lane.verdict,
                  f32 ? decide_one(block_of(*lane.lane), stored) : decide_one(block_of(*lane.lane), pair));
        EXPECT_NE(lane.verdict, truth);
        EXPECT_EQ(cause_of(*lane.lane, pair, truth), lane.cause) << lane.lane->id;
        const bool is_right_about_stored = lane.verdict == of_stored || of_stored == Verdict::declined;
        EXPECT_EQ(lane.cause == Cause::stored, f32 && of_stored != truth && is_right_about_stored);
        if (lane.cause == Cause::stored) continue;
        EXPECT_EQ(lane.cause == Cause::logic, lane.exactly.verdict != (f32 ? of_stored : truth)) << lane.lane->id;
        if (f32) {  // the explanation is that of the stored pair
          EXPECT_EQ(cause_of(*lane.lane, stored, of_stored), lane.cause)
              << lane.lane->id << ' ' << name(lane.verdict) << ' ' << name(truth) << ' ' << name(of_stored);
        } else if (lane.cause == Cause::rounding && lane.bits_needed > 0) {
          EXPECT_EQ(oracle::decide_with_bits(lane.lane->algorithm, pair, lane.bits_needed), truth);
          EXPECT_EQ(oracle::decide_with_bits(lane.lane->algorithm, pair, lane.bits_needed, Scalar::f64) == truth,
                    lane.bits_alone);
        }
      }
    }
  }
  EXPECT_GT(seen[Cause::stored], 100);
  EXPECT_GT(seen[Cause::rounding], 50);
  EXPECT_GT(seen[Cause::contraction], 5);
  EXPECT_GT(seen[Cause::logic], 5);
  EXPECT_GT(settled, wrong / 2);
}

// The explanation names a number that decides alone, and a number that float32 cannot hold.
TEST(ExplainDoubles, TheNumberThatDecidesIsNamed) {
  DoublePair pair{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 0, 1}, {1, 0, 2}, {0, 1, 2}}};
  pair.b[0].z = 1 + 0x1p-40;
  const Explanation near = explain(pair, lanes_of_doubles());
  const LaneExplanation& lane = lane_of(near, "guigue_devillers_2003/f32/cpu");
  EXPECT_EQ(lane.cause, Cause::stored);
  EXPECT_EQ(lane.settled, Settled::yes);
  EXPECT_EQ(lane.experiment, "if only number 12 were kept as 1.0000000000009095, the verdict would be disjoint");
  EXPECT_NE(sentence(near, lane.lane->info).find("float32 stores another pair, for which that is right"),
            std::string::npos);
  for (const LaneExplanation& other : near.lanes) EXPECT_EQ(other.lane->scalar, Scalar::f32);
  pair.b[1].z = 1e300;
  const Explanation large = explain(pair, lanes_of_doubles());
  EXPECT_EQ(lane_of(large, "guigue_devillers_2003/f32/cpu").experiment, "number 15, 1e+300, is beyond float32's range");
}

}  // namespace
}  // namespace graze::analysis
