// SPDX-License-Identifier: Apache-2.0
#include "analysis/invariants.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/explain.h"
#include "analysis/neighbours.h"
#include "analysis/scales.h"
#include "core/message_testing.h"
#include "cuda/twin/twin.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

bool simpler(const AnyPair& l, const AnyPair& r) {
  const auto size = [](const AnyPair& pair) {
    double sum = 0;
    for (int c = 0; c < kCoordinates; ++c) sum += std::fabs(coordinates(pair.doubles)[c]);
    return sum;
  };
  return size(l) < size(r);
}

InvariantSpec spec_of(const std::vector<std::string>& ids, std::uint64_t pairs,
                      const std::vector<std::string>& strata = {}, PairTypes types = PairTypes::f32) {
  InvariantSpec spec;
  for (const std::string& id : ids) {
    spec.lanes.push_back(find_lane(id));
    if (!spec.lanes.back()) throw std::logic_error(id + ": expected a lane");
    spec.on_host.push_back(cuda::block_on_host(*spec.lanes.back()));
  }
  spec.sources = strata::stratum_sources(7, pairs, strata, types);
  spec.simpler = simpler;
  return spec;
}

std::string refusal(const InvariantSpec& spec) {
  return error_of<InvariantBroken>([&] { invariants(spec); });
}

// The pairs as text, in the same order.
template <class Real>
std::vector<std::string> texts(const std::vector<BasicPair<Real>>& pairs) {
  std::vector<std::string> all;
  for (const BasicPair<Real>& pair : pairs) {
    all.emplace_back();
    for (int c = 0; c < kCoordinates; ++c) all.back() += fmt::format("{:a} ", coordinates(pair)[c]);
  }
  return all;
}

TEST(Invariants, ImagesAskTheSameQuestion) {
  for (const PairTypes types : {PairTypes::f32, PairTypes::f64}) {
    std::set<Invariant> asked;
    const auto expect_same_question = [&](const auto& pair, const std::string& source) {
      const Verdict truth = oracle::truth(pair).verdict;
      for (const InvariantInfo& invariant : kInvariants) {
        std::set<std::string> different;
        for (const auto& image : images(invariant.invariant, pair)) {
          EXPECT_FALSE(breaks(invariant.invariant, truth, oracle::truth(image).verdict))
              << invariant.id << " of " << source;
          different.insert(texts(std::vector{image}).front());
          asked.insert(invariant.invariant);
        }
        if (!source.starts_with("uniform")) continue;
        const std::size_t all[] = {1, 35, 7, 5, 8};
        if (static_cast<std::size_t>(invariant.invariant) < std::size(all)) {
          EXPECT_EQ(different.size(), all[static_cast<std::size_t>(invariant.invariant)]) << invariant.id;
        }
      }
    };
    for (const strata::PairSource& source : strata::stratum_sources(3, 228, {}, types)) {
      for (std::uint64_t i = 0; i < source.pairs; ++i)
        visit(source.any_pair(i), [&](const auto& pair) { expect_same_question(pair, source.id); });
    }
    EXPECT_EQ(asked.size(), kInvariantCount);
  }
}

TEST(Invariants, NoImageThatWouldLoseBits) {
  Pair pair{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 0, 1}, {0, 1, 0x1p-149f}}};
  // Scaling down would lose 2^-149, so only the four factors above 1 remain.
  EXPECT_EQ(images(Invariant::scale, pair).size(), 4u);
  // Only translations that do not change z remain, because float32 cannot represent 1 ± 2^-149.
  EXPECT_EQ(images(Invariant::translate, pair).size(), 3u);
  EXPECT_EQ(images(Invariant::part, pair).size(), 4u);
  EXPECT_EQ(images(Invariant::part, images(Invariant::swap, pair).front()).size(), 4u);
  pair.b[2].z = 0;
  EXPECT_EQ(images(Invariant::scale, pair).size(), 8u);
  EXPECT_EQ(images(Invariant::translate, pair).size(), 8u);
  EXPECT_EQ(images(Invariant::part, pair).size(), 8u);
  pair.a[1].x = 0x1p127f;
  EXPECT_EQ(images(Invariant::scale, pair).size(), 4u);
  // The sum of two coordinates overflows, but half of the sum does not.
  pair.a[0].x = 0x1.8p127f;
  EXPECT_EQ(images(Invariant::part, pair).size(), 8u);
}

// A double can hold numbers that a float32 cannot, but it has limits too.
TEST(Invariants, ImagesOfDoublesLoseNoBitOfADouble) {
  const Pair floats{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 0, 1}, {0, 1, 0x1p-52f}}};
  DoublePair pair = in_doubles(floats);
  EXPECT_EQ(images(Invariant::translate, floats).size(), 3u);
  EXPECT_EQ(images(Invariant::translate, pair).size(), 8u);
  EXPECT_EQ(images(Invariant::part, floats).size(), 4u);
  EXPECT_EQ(images(Invariant::part, pair).size(), 8u);
  pair.b[2].z = 0x1p-1074;
  EXPECT_EQ(images(Invariant::scale, pair).size(), 4u);
  EXPECT_EQ(images(Invariant::translate, pair).size(), 3u);
  EXPECT_EQ(images(Invariant::part, pair).size(), 4u);
  pair.a[1].x = 0x1p1023;
  EXPECT_EQ(images(Invariant::scale, pair).size(), 0u);
}

Pair changed(const Pair& pair, float scale, float step) {
  Pair image;
  for (int c = 0; c < kCoordinates; ++c) coordinates(image)[c] = coordinates(pair)[c] * scale + step;
  return image;
}

// Each function returns the pair itself first, and each image once.
TEST(Invariants, NoWayIsMissingAndNoneIsThereTwice) {
  const Pair pair{{{1, 2, 3}, {2, 0, 1}, {5, 1, 1}}, {{-1, 4, 2}, {0, 1, 6}, {3, 3, -2}}};
  const std::vector<std::pair<std::vector<Pair>, std::size_t>> ways = {{orders(pair), 72},    {mirrored(pair), 8},
                                                                       {axes(pair), 6},       {scalings(pair), 129},
                                                                       {translated(pair), 9}, {parts(pair), 9}};
  for (const auto& [pairs, count] : ways) {
    const std::vector<std::string> all = texts(pairs);
    EXPECT_EQ(all.size(), count);
    EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), count);
    EXPECT_EQ(all.front(), texts(std::vector{pair}).front()) << count;
  }
}

TEST(Invariants, ScaleByThesePowersAndMoveByTheLargestCoordinates) {
  Pair pair{{{9, 2, 3}, {2, 0, 1}, {5, 1, 1}}, {{-1, 4, 2}, {0, 1, 6}, {3, 3, -2}}};
  std::vector<Pair> scaled;
  for (const float k : {2.0f, 0.5f, 16.0f, 0x1p-4f, 0x1p16f, 0x1p-16f, 0x1p64f, 0x1p-64f})
    scaled.push_back(changed(pair, k, 0));
  EXPECT_EQ(texts(images(Invariant::scale, pair)), texts(scaled));
  for (int largest = 0; largest < kCoordinates; ++largest) {
    std::swap(coordinates(pair)[0], coordinates(pair)[largest]);
    const std::vector<std::string> moved = texts(translated(pair));
    for (const float step : {8.0f, -8.0f})
      EXPECT_EQ(std::count(moved.begin(), moved.end(), texts(std::vector{changed(pair, 1, step)}).front()), 1)
          << largest;
    std::swap(coordinates(pair)[0], coordinates(pair)[largest]);
  }
}

TEST(Invariants, NudgesAreAnUlpAndAThousandthOfTheCoordinateOrOfTheLargest) {
  Pair pair{};
  coordinates(pair)[3] = 0x1p-20f;
  coordinates(pair)[17] = -0x1p-10f;
  const auto steps = [&](int coordinate) {
    std::vector<float> all;
    for (const Pair& moved : nudged(pair, coordinate))
      all.push_back(coordinates(moved)[coordinate] - coordinates(pair)[coordinate]);
    return all;
  };
  EXPECT_EQ(steps(3), (std::vector<float>{0x1p-43f, -0x1p-43f, 0x1p-30f, -0x1p-30f}));
  EXPECT_EQ(steps(0), (std::vector<float>{0x1p-33f, -0x1p-33f, 0x1p-20f, -0x1p-20f}));
  EXPECT_EQ(steps(16), steps(0));
  coordinates(pair)[17] = 0;
  EXPECT_EQ(steps(0), (std::vector<float>{0x1p-43f, -0x1p-43f, 0x1p-30f, -0x1p-30f}));
}

TEST(Invariants, WhatBreaksThem) {
  constexpr Verdict yes = Verdict::intersects, no = Verdict::disjoint, none = Verdict::declined;
  EXPECT_TRUE(breaks(Invariant::swap, yes, no));
  EXPECT_TRUE(breaks(Invariant::swap, no, none));
  EXPECT_FALSE(breaks(Invariant::swap, none, none));
  EXPECT_TRUE(breaks(Invariant::part, no, yes));
  EXPECT_FALSE(breaks(Invariant::part, yes, no));
  EXPECT_FALSE(breaks(Invariant::part, none, yes));
}

// Every published algorithm has a row in kClaims that claims at least one invariant.
TEST(Invariants, EachAlgorithmSaysWhatItClaims) {
  for (const Lane& lane : published_lanes()) EXPECT_FALSE(claimed_invariants(lane.info->id).empty()) << lane.info->id;
  EXPECT_TRUE(claims(*find_lane("separating_axes/f32/cuda-nofma"), Invariant::swap));
  EXPECT_FALSE(claims(*find_lane("separating_axes/f32/cuda-fma"), Invariant::swap));
  EXPECT_FALSE(claims(*find_lane("separating_axes/f32/cpu"), Invariant::order));
  EXPECT_FALSE(claims(*find_lane("exact/f32/cpu"), Invariant::scale));
}

std::vector<std::string> lanes_of(const std::vector<Variant>& variants) {
  std::vector<std::string> ids;
  for (const Lane& lane : published_lanes()) {
    if (std::find(variants.begin(), variants.end(), lane.variant) != variants.end()) ids.push_back(lane.id);
  }
  return ids;
}

// Every claim holds on every stratum, and each invariant that is not claimed is broken by some pair.
TEST(Invariants, ClaimsHoldAndNothingElseDoes) {
  const std::vector<std::string> ids = lanes_of({Variant::cpu, Variant::cuda_nofma});
  const InvariantSpec spec = spec_of(ids, strata::kStrataCount * 150);
  const Invariants found = invariants(spec);  // throws where a claim is broken
  EXPECT_EQ(found.pairs, strata::kStrataCount * 150u);
  for (std::size_t l = 0; l < ids.size(); ++l) {
    for (const InvariantInfo& invariant : kInvariants) {
      const InvariantCount count = found.lanes[l].total(invariant.invariant);
      EXPECT_GT(count.pairs, 100u) << invariant.id;
      if (spec.lanes[l]->scalar == Scalar::f32 && !claims(*spec.lanes[l], invariant.invariant)) {
        EXPECT_GT(count.changed, 0u) << ids[l] << " " << invariant.id;
      }
    }
  }
}

// Lanes in float decide the pairs of doubles as float32 stores them, and the images of these stored pairs. So the
// claims hold here too.
TEST(Invariants, ClaimsHoldOnDoubles) {
  std::vector<std::string> ids = lanes_of({Variant::cpu});
  ids.insert(ids.end(), {"exact/f32/cpu", "exact/f64/cpu"});
  const InvariantSpec spec = spec_of(ids, 2000, {}, PairTypes::f64);
  const Invariants found = invariants(spec);  // throws where a claim is broken
  std::uint64_t stored = 0;
  for (const strata::PairSource& source : spec.sources) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) stored += is_finite(stored_in_float32(source.double_pair(i)));
  }
  EXPECT_EQ(found.pairs, 2000 + stored);
  EXPECT_LT(stored, 2000u);  // float32 cannot hold the largest doubles
  EXPECT_GT(found.its_images, 10'000u);
  for (std::size_t l = 0; l < ids.size(); ++l) {
    for (const InvariantInfo& invariant : kInvariants) {
      const InvariantCount count = found.lanes[l].total(invariant.invariant);
      EXPECT_GT(count.pairs, 100u) << invariant.id;
      if (spec.lanes[l]->exact) {
        EXPECT_EQ(count.changed, 0u) << ids[l] << " " << invariant.id;
      } else if (!claims(*spec.lanes[l], invariant.invariant)) {
        EXPECT_GT(count.changed, 0u) << ids[l] << " " << invariant.id;
      }
      const std::optional<InvariantCase>& kept = found.lanes[l].simplest[static_cast<std::size_t>(invariant.invariant)];
      if (kept) {
        EXPECT_EQ(kept->pair.floats.has_value(), spec.lanes[l]->scalar == Scalar::f32);
      }
    }
  }
}

// The counts equal those of a plain loop over pairs and images.
TEST(Invariants, CountsAreThoseOfAPlainLoop) {
  const InvariantSpec spec =
      spec_of({"moller_1997/f32/cpu", "moller_1997/f64/cpu", "guigue_devillers_2003/f32/cuda-fma"}, 600,
              {"near_edge_edge", "lattice"}, PairTypes::both);
  ASSERT_EQ(spec.sources.size(), 4u);
  const Invariants found = invariants(spec);
  // The source's pair in the type that the lane decides.
  const auto taken = [&](std::size_t l, const strata::PairSource& source, std::uint64_t i) {
    const AnyPair pair = source.any_pair(i);
    return spec.lanes[l]->scalar == Scalar::f64 || pair.floats ? pair : stored_in_float32(pair.doubles);
  };
  std::uint64_t changes = 0;
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    for (const InvariantInfo& invariant : kInvariants) {
      for (std::size_t s = 0; s < spec.sources.size(); ++s) {
        InvariantCount counted;
        for (std::uint64_t i = 0; i < spec.sources[s].pairs; ++i) {
          visit(taken(l, spec.sources[s], i), [&](const auto& pair) {
            const auto all = images(invariant.invariant, pair);
            const Lane& host = *counterpart(*spec.lanes[l], Variant::cpu);
            const auto breaks_it = [&](const auto& image) {
              return breaks(invariant.invariant, decide_one(spec.on_host[l], pair), decide_one(spec.on_host[l], image));
            };
            counted.pairs += !all.empty();
            counted.changed += std::any_of(all.begin(), all.end(), breaks_it);
            counted.in_range +=
                !leaves_exponents(host, pair) && std::any_of(all.begin(), all.end(), [&](const auto& image) {
                  return breaks_it(image) && !leaves_exponents(host, image);
                });
          });
        }
        const InvariantCount& count = found.lanes[l].counts[static_cast<std::size_t>(invariant.invariant)][s];
        EXPECT_EQ(count.pairs, counted.pairs) << spec.lanes[l]->id << " " << invariant.id;
        EXPECT_EQ(count.changed, counted.changed) << spec.lanes[l]->id << " " << invariant.id;
        EXPECT_EQ(count.in_range, counted.in_range) << spec.lanes[l]->id << " " << invariant.id;
        changes += count.changed;
      }
      const std::optional<InvariantCase>& kept = found.lanes[l].simplest[static_cast<std::size_t>(invariant.invariant)];
      ASSERT_EQ(kept.has_value(), found.lanes[l].total(invariant.invariant).changed > 0);
      if (!kept) continue;
      const auto says = [&](const AnyPair& pair) {
        return visit(pair, [&](const auto& own) { return decide_one(spec.on_host[l], own); });
      };
      EXPECT_EQ(says(kept->pair), kept->of_pair);
      EXPECT_EQ(says(kept->image), kept->of_image);
      EXPECT_TRUE(breaks(invariant.invariant, kept->of_pair, kept->of_image));
    }
  }
  EXPECT_GT(changes, 100u);
  std::uint64_t all = 0;
  for (const strata::PairSource& source : spec.sources) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) {
      for (const InvariantInfo& invariant : kInvariants) {
        all += images(invariant.invariant, *taken(0, source, i).floats).size();
        if (source.in_doubles()) all += images(invariant.invariant, source.double_pair(i)).size();
      }
    }
  }
  EXPECT_EQ(found.images, all);
  EXPECT_GT(found.its_images, found.by_oracle);
  EXPECT_LT(found.its_images, all);
}

// Each power of two is also counted alone. All powers together change more pairs than any single power.
TEST(Invariants, EachScaleIsCountedAlone) {
  const InvariantSpec spec =
      spec_of({"projected_sat/f32/cpu", "moller_1997/f32/cpu"}, 1000, {"near_edge_edge", "extreme_scale"});
  const Invariants found = invariants(spec);
  std::uint64_t most = 0, least = ~std::uint64_t{0};
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    const InvariantsOfLane& of = found.lanes[l];
    for (std::size_t s = 0; s < kScales.size(); ++s) {
      InvariantCount counted;
      for (const strata::PairSource& source : spec.sources) {
        for (std::uint64_t i = 0; i < source.pairs; ++i) {
          const Pair pair = source.pair(i);
          const std::optional<Pair> image = exactly_scaled(pair, kScales[s]);
          if (!image) continue;
          const bool changed = decide_one(spec.on_host[l], pair) != decide_one(spec.on_host[l], *image);
          const bool leaves = leaves_exponents(*spec.lanes[l], pair) || leaves_exponents(*spec.lanes[l], *image);
          counted += {1, changed, changed && !leaves};
        }
      }
      EXPECT_EQ(of.by_scale[s].pairs, counted.pairs) << kScales[s];
      EXPECT_EQ(of.by_scale[s].changed, counted.changed) << kScales[s];
      EXPECT_EQ(of.by_scale[s].in_range, counted.in_range) << kScales[s];
      EXPECT_LE(of.by_scale[s].changed, of.total(Invariant::scale).changed);
      if (l == 0) most = std::max(most, counted.in_range), least = std::min(least, counted.in_range);
    }
  }
  EXPECT_GT(most, least);
  EXPECT_GT(found.lanes[0].total(Invariant::scale).in_range, most);
}

// Pairs and images that a lane's convention excludes are not counted.
TEST(Invariants, WhatAConventionLeavesOpenIsNotAsked) {
  InvariantSpec spec = spec_of({"moller_1997/f32/cpu"}, 40, {"shared_vertex", "near_edge_edge"});
  const Invariants all = invariants(spec);
  Lane lane = *spec.lanes[0];
  lane.outside = kOutsideShared;
  spec.lanes[0] = &lane;
  const Invariants asked = invariants(spec);
  for (const InvariantInfo& invariant : kInvariants) {
    const auto &with = asked.lanes[0].counts[static_cast<std::size_t>(invariant.invariant)],
               &without = all.lanes[0].counts[static_cast<std::size_t>(invariant.invariant)];
    EXPECT_EQ(with[0].pairs, without[0].pairs) << invariant.id;  // near_edge_edge
    EXPECT_EQ(with[0].changed, without[0].changed) << invariant.id;
    EXPECT_EQ(with[1].pairs, 0u) << invariant.id;
  }
  // The second triangle pierces the first and touches one of its parts. This lane says "intersects" on that part only.
  spec.sources = {{"one", 1, [](std::uint64_t) {
                     return Pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{2, 1, -1}, {2, 1, 1}, {6, 1, 0}}};
                   }}};
  spec.on_host[0] =
      DecideBlock(+[](const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
        std::fill_n(intersects, (count + 63) / 64, 0);
        std::fill_n(declined, (count + 63) / 64, 0);
        for (std::size_t i = 0; i < count; ++i) {
          const Vec3<float>(&a)[3] = pairs[i].a;
          if (a[0].x + a[1].x + a[2].x == 4 && a[0].y + a[1].y + a[2].y == 4 && a[0].x < 3 && a[1].x < 3 && a[2].x < 3)
            intersects[i / 64] |= std::uint64_t{1} << i % 64;
        }
      });
  EXPECT_EQ(invariants(spec).lanes[0].total(Invariant::part).changed, 1u);
  lane.outside = kOutsideTouching;
  EXPECT_EQ(invariants(spec).lanes[0].total(Invariant::part).changed, 0u);
  // Pairs that share an area are counted, although an ulp can separate them. Disjoint pairs are counted too, but
  // touching pairs are not.
  for (const auto& [x, asked_about] : {std::pair{1.0f, 1u}, {4.0f, 0u}, {9.0f, 1u}}) {
    spec.sources = {{"one", 1, [x](std::uint64_t) {
                       return Pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{x, 0, 0}, {x + 4, 0, 0}, {x, 4, 0}}};
                     }}};
    for (const InvariantInfo& invariant : kInvariants)
      EXPECT_EQ(invariants(spec).lanes[0].total(invariant.invariant).pairs, asked_about) << invariant.id << ' ' << x;
  }
}

// in_range is not known for foreign code, whose steps are not visible, nor under a tolerance, which changes the steps.
TEST(Invariants, RangeIsKnownOfPublishedLanesAlone) {
  Lane lane = *find_lane("moller_1997/f32/cpu");
  EXPECT_TRUE(knows_range(lane));
  lane.policy = "rel:16";
  EXPECT_FALSE(knows_range(lane));
  lane.policy = "";
  lane.algorithm = -1;
  EXPECT_FALSE(knows_range(lane));
}

TEST(Invariants, AreTheSameWhateverTheThreads) {
  InvariantSpec spec = spec_of({"moller_1997/f32/cpu", "separating_axes/f64/cpu"}, 600, {"near_*"});
  spec.threads = 1;
  const Invariants one = invariants(spec);
  spec.threads = 3;
  const Invariants three = invariants(spec);
  EXPECT_EQ(one.images, three.images);
  EXPECT_EQ(one.its_images, three.its_images);
  EXPECT_EQ(one.by_oracle, 4u * 19);  // 19 of the 150 pairs of each stratum
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    for (const InvariantInfo& invariant : kInvariants) {
      EXPECT_EQ(one.lanes[l].total(invariant.invariant).changed, three.lanes[l].total(invariant.invariant).changed);
      const auto &kept = one.lanes[l].simplest[static_cast<std::size_t>(invariant.invariant)],
                 &again = three.lanes[l].simplest[static_cast<std::size_t>(invariant.invariant)];
      ASSERT_EQ(kept.has_value(), again.has_value());
      if (kept) {
        EXPECT_EQ(kept->place, again->place);
      }
    }
  }
}

// The run stops if a verdict of the exact decision or of the oracle breaks an invariant.
TEST(Invariants, StopWhereTheTruthBreaksOne) {
  InvariantSpec spec = spec_of({"moller_1997/f32/cpu"}, 40, {"shared_vertex"});
  const Pair swapped = images(Invariant::swap, spec.sources[0].pair(3)).front();
  static Pair wrong_on;
  wrong_on = swapped;
  spec.exact =
      DecideBlock(+[](const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
        find_lane("exact/f32/cpu")->decide(pairs, count, intersects, declined);
        for (std::size_t i = 0; i < count; ++i) {
          if (std::equal(coordinates(pairs[i]), coordinates(pairs[i]) + kCoordinates, coordinates(wrong_on)))
            intersects[i / 64] ^= std::uint64_t{1} << i % 64;
        }
      });
  EXPECT_EQ(
      refusal(spec),
      "exact breaks the invariant \"swap\" on pair 3 of shared_vertex: it says intersects, but on an image disjoint");
  spec.exact = find_lane("exact/f32/cpu")->decide;
  EXPECT_EQ(refusal(spec), "");
  spec.oracle_every = 1;
  spec.intersects = [&](const AnyPair& pair) {
    return oracle_intersects(pair) !=
           std::equal(coordinates(*pair.floats), coordinates(*pair.floats) + kCoordinates, coordinates(swapped));
  };
  EXPECT_EQ(refusal(spec),
            "the oracle breaks the invariant \"swap\" on pair 3 of shared_vertex: it says intersects, but on an image "
            "disjoint");
  // A wrong verdict on the pair itself is found before its images are tested.
  spec.intersects = [&](const AnyPair& pair) { return oracle_intersects(pair) && simpler(pair, pair); };
  EXPECT_EQ(refusal(spec), "exact and the oracle differ on pair 0 of shared_vertex: intersects and disjoint");
}

// The run stops if a lane breaks an invariant that it claims, or if an exact lane breaks one.
TEST(Invariants, StopWhereAClaimIsBroken) {
  InvariantSpec spec = spec_of({"separating_axes/f64/cpu"}, 2000, {"near_*"});
  EXPECT_EQ(refusal(spec), "");
  spec.on_host[0] = find_lane("moller_1997/f64/cpu")->decide;  // breaks the invariants that separating_axes claims
  EXPECT_TRUE(
      refusal(spec).starts_with("separating_axes/f64/cpu, which claims it, breaks the invariant \"swap\" on pair "))
      << refusal(spec);
  InvariantSpec exact = spec_of({"exact/f32/cpu"}, 2000, {"near_*"});
  exact.on_host[0] = find_lane("moller_1997/f64/cpu")->decide;
  EXPECT_TRUE(refusal(exact).starts_with("exact/f32/cpu breaks the invariant \"order\" on pair ")) << refusal(exact);
}

}  // namespace
}  // namespace graze::analysis
