// SPDX-License-Identifier: Apache-2.0
// Runs the engine's steps on the host and compares the result with a direct computation from the oracle's bucket of
// each pair.
#include "cuda/engine/engine.h"
#include "core/counts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/exact/exact.h"
#include "core/exact/find_nesting.h"
#include "core/relation_of.h"
#include "cuda/engine/host_engine_testing.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

constexpr std::uint64_t kSeed = 5;

Verdict truth_of(const Pair& pair) {
  return exact::intersects(coordinates(pair), coordinates(pair) + 9) ? Verdict::intersects : Verdict::disjoint;
}

// The verdict of a lane that declines or is wrong on one pair in 40 on average. The pairs differ from lane to lane.
Verdict wrong_at_times(const Pair& pair, std::uint64_t lane) {
  std::uint64_t hash = lane;
  for (int k = 0; k < kCoordinates; ++k)
    hash = (hash ^ std::bit_cast<std::uint32_t>(coordinates(pair)[k])) * 0x9e3779b97f4a7c15u + (hash >> 31);
  const Verdict truth = truth_of(pair);
  const std::uint64_t choice = (hash >> 20) % 80;
  return choice == 0                  ? Verdict::declined
         : choice > 1                 ? truth
         : truth == Verdict::disjoint ? Verdict::intersects
                                      : Verdict::disjoint;
}

template <std::uint64_t lane>
void decide_wrongly(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  std::fill_n(intersects, (count + 63) / 64, 0);
  std::fill_n(declined, (count + 63) / 64, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const Verdict verdict = wrong_at_times(pairs[i], lane);
    intersects[i / 64] |= std::uint64_t{verdict == Verdict::intersects} << (i % 64);
    declined[i / 64] |= std::uint64_t{verdict == Verdict::declined} << (i % 64);
  }
}

// Three groups of 3, 71 and 2 lanes, and an exact lane.
class EngineTest : public testing::Test {
 protected:
  static constexpr std::size_t kGroups[] = {3, 71, 2};

  EngineTest() {
    const std::vector<DecideBlock> blocks = all(std::make_index_sequence<76>());
    std::size_t next = 0;
    for (std::size_t group = 0; group < 3; ++group) {
      for (std::size_t k = 0; k < kGroups[group]; ++k) {
        const Lane& of_subject = *std::find_if(graze::lanes().begin(), graze::lanes().end(), [&](const Lane& lane) {
          return lane.algorithm == static_cast<int>(group);
        });
        lanes_.push_back(&of_subject);
        on_host_.push_back(blocks[next++]);
      }
    }
    lanes_.push_back(&graze::lanes().back());  // exact
    on_host_.push_back(nullptr);
  }

  template <std::size_t... lane>
  static std::vector<DecideBlock> all(std::index_sequence<lane...>) {
    return {decide_wrongly<lane>...};
  }

  EngineResult run(strata::Stratum stratum, std::uint64_t first, std::uint64_t count,
                   const EngineLimits& limits = {}) const {
    const strata::StratumInfo& row = strata::kStrata[static_cast<std::size_t>(stratum)];
    const strata::PairSource source = strata::stratum_sources(kSeed, 1, {std::string(row.id)}).front();
    return make_host_engine(lanes_, on_host_, limits)->run(source, first, count);
  }

  std::vector<const Lane*> lanes_;
  std::vector<DecideBlock> on_host_;
};

using Key = std::tuple<std::uint16_t, int, std::uint32_t, std::vector<Verdict>>;

struct Found {
  std::uint64_t count = 0;
  std::vector<std::uint64_t> cases;
  bool operator==(const Found&) const = default;
};

TEST_F(EngineTest, AnyNumberOfLanesCountsAsThePlainWay) {
  EngineLimits limits;
  limits.block_pairs = 1000;  // this is not a multiple of 64, and the last block is shorter
  constexpr std::uint64_t kFirst = 77, kCount = 3333;
  for (const strata::Stratum stratum : {strata::Stratum::degenerate, strata::Stratum::far_from_origin}) {
    const EngineResult result = run(stratum, kFirst, kCount, limits);
    EXPECT_EQ(result.done, kCount);
    const Axis axis = strata::kStrata[static_cast<std::size_t>(stratum)].axis;
    std::vector<std::uint64_t> counts(engine_counters(lanes_.size())), extremes(counts.size());
    std::map<Key, Found> signatures;
    std::uint64_t disagreements = 0;
    for (std::uint64_t index = kFirst; index < kFirst + kCount; ++index) {
      if (std::binary_search(result.undecided.begin(), result.undecided.end(), index)) continue;
      const Pair pair = strata::generate(kSeed, stratum, index);
      const Verdict truth = truth_of(pair);
      const Bucket bucket = oracle::margin_bucket(pair, truth);
      const Relation r = relation_of(pair);
      const Nesting nesting = exact::detail::nesting(
          exact::detail::triangles<exact::detail::WideNumbers>(coordinates(pair), coordinates(pair) + 9), r);
      std::vector<Verdict> verdicts;
      for (std::size_t l = 0; l + 1 < lanes_.size(); ++l) verdicts.push_back(wrong_at_times(pair, l));
      verdicts.push_back(truth);
      for (const auto& [into, place] : {std::pair{&counts, bucket}, {&extremes, place_on_axis(pair, axis)}}) {
        const auto count = [&, at = static_cast<std::size_t>(place + kBucketMost)](std::size_t counter, bool yes) {
          (*into)[counter * kBucketCount + at] += yes;
        };
        count(0, true);
        count(1, truth == Verdict::intersects);
        for (std::size_t l = 0; l < verdicts.size(); ++l) {
          count(2 + 3 * l, verdicts[l] == Verdict::intersects && truth == Verdict::disjoint);
          count(3 + 3 * l, verdicts[l] == Verdict::disjoint && truth == Verdict::intersects);
          count(4 + 3 * l, verdicts[l] == Verdict::declined);
        }
      }
      bool any = false;  // a declined verdict is not a disagreement
      std::uint32_t first = 0;
      for (const std::size_t group : kGroups) {
        const std::vector<Verdict> own(verdicts.begin() + first, verdicts.begin() + first + static_cast<int>(group));
        if (std::any_of(own.begin(), own.end(), [&](Verdict v) { return is_wrong(v, truth); })) {
          Found& found = signatures[{packed(r, nesting), bucket, first, own}];
          ++found.count;
          if (found.cases.size() < kEngineCases) found.cases.push_back(index);
          any = true;
        }
        first += static_cast<std::uint32_t>(group);
      }
      disagreements += any;
    }
    EXPECT_EQ(result.counts, counts);
    EXPECT_EQ(result.extreme_counts, axis == Axis::none ? std::vector<std::uint64_t>{} : extremes);
    EXPECT_EQ(result.disagreements, disagreements);
    std::map<Key, Found> found;
    for (const EngineSignature& s : result.signatures) {
      const Key key{packed(s.relation, s.nesting), s.bucket, s.lanes.first, s.verdicts};
      EXPECT_TRUE(found.insert({key, {s.count, s.cases}}).second) << "one signature in two rows";
    }
    EXPECT_EQ(found, signatures);
    EXPECT_GT(signatures.size(), 1000u);
    EXPECT_LT(result.undecided.size(), kCount / 20);
  }
}

TEST_F(EngineTest, GroupsAreRunsOfOneAlgorithmWithoutTheExactLanes) {
  const std::vector<LaneGroup> groups = lane_groups(lanes_);
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[1].first, 3u);
  EXPECT_EQ(groups[1].count, 71u);
  EXPECT_EQ(key_words(groups), 1u + 3u);  // 71 lanes of two bits each
  EXPECT_EQ(key_words({}), 1u);
}

// On doubles, an exact float32 lane fails if storing the pair as float32 changes its verdict.
TEST_F(EngineTest, GroupsOnDoublesHoldTheExactLanes) {
  const std::vector<LaneGroup> groups = lane_groups(lanes_, true);
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[3].first, 76u);
  EXPECT_EQ(groups[3].count, 1u);
}

// Checks the counts of a lane in float, of a lane in double, and of both exact lanes.
TEST(EngineOnDoubles, CountsAsThePlainWayAndLeavesFewPairs) {
  constexpr std::uint64_t kCount = 1000;
  constexpr const char* kLanes[] = {"moller_1997/f32/cpu", "moller_1997/f64/cpu", "exact/f32/cpu", "exact/f64/cpu"};
  std::vector<const Lane*> lanes;
  std::vector<DecideBlock> on_host;
  for (const char* id : kLanes) {
    lanes.push_back(find_lane(id));
    on_host.push_back(lanes.back()->decide);
  }
  std::uint64_t stored = 0;
  for (const strata::PairSource& source : strata::stratum_sources(kSeed, 1, {}, PairTypes::f64)) {
    EngineLimits limits;
    limits.block_pairs = 300;
    const EngineResult result = make_host_engine(lanes, on_host, limits)->run(source, 7, kCount);
    EXPECT_EQ(result.done, kCount);
    EXPECT_LT(result.undecided.size(), kCount * (source.id == "mixed_scale/f64" ? 60 : 3) / 100) << source.id;
    std::vector<std::uint64_t> counts(engine_counters<DoubleEngineBlock>(lanes.size())), extremes(counts.size());
    for (std::uint64_t index = 7; index < 7 + kCount; ++index) {
      if (std::binary_search(result.undecided.begin(), result.undecided.end(), index)) continue;
      const DoublePair pair = source.double_pair(index);
      const Pair in_float32 = stored_in_float32(pair);
      const Verdict truth = oracle::cgal_verdict(pair);
      const Bucket bucket = oracle::margin_bucket(pair, truth);
      const bool changed = !is_finite(in_float32) || truth_of(in_float32) != truth;
      for (const auto& [into, place] : {std::pair{&counts, bucket}, {&extremes, place_on_axis(pair, source.axis)}}) {
        const auto count = [&, at = static_cast<std::size_t>(place + kBucketMost)](std::size_t counter, bool yes) {
          (*into)[counter * kBucketCount + at] += yes;
        };
        count(0, true);
        count(1, truth == Verdict::intersects);
        for (std::size_t l = 0; l < lanes.size(); ++l) {
          const bool in_float = lanes[l]->scalar == Scalar::f32;
          const Verdict verdict = in_float ? decide_one(on_host[l], in_float32) : decide_one(on_host[l], pair);
          count(2 + 4 * l, verdict == Verdict::intersects && truth == Verdict::disjoint);
          count(3 + 4 * l, verdict == Verdict::disjoint && truth == Verdict::intersects);
          count(4 + 4 * l, verdict == Verdict::declined);
          const bool by_storing = in_float && changed && is_wrong(verdict, truth);
          count(5 + 4 * l, by_storing);
          stored += by_storing;
        }
      }
    }
    EXPECT_EQ(result.counts, counts) << source.id;
    EXPECT_EQ(result.extreme_counts, source.axis == Axis::none ? std::vector<std::uint64_t>{} : extremes) << source.id;
  }
  EXPECT_GT(stored, 1000u);
}

template <class Do>
std::string error_of(const Do& act) {
  try {
    act();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_F(EngineTest, AFullSignatureTableIsAnError) {
  EngineLimits limits;
  limits.signatures = 64;
  EXPECT_EQ(error_of([&] { run(strata::Stratum::degenerate, 0, 2000, limits); }),
            "the engine found more signatures than its table has rows");
}

// A stratum whose first 20,000 pairs include some that the bounds leave open.
constexpr strata::Stratum kLeavesSome = strata::Stratum::mixed_scale;

TEST_F(EngineTest, MoreUndecidedPairsThanTheListHoldsAreAnError) {
  EngineLimits limits;
  const std::size_t left = run(kLeavesSome, 0, 20'000, limits).undecided.size();
  ASSERT_GT(left, 2u);
  EXPECT_LT(left, 60u);  // double-double bounds decide all other pairs
  limits.undecided = static_cast<std::uint32_t>(left);
  EXPECT_EQ(run(kLeavesSome, 0, 20'000, limits).undecided.size(), left);
  --limits.undecided;
  EXPECT_EQ(error_of([&] { run(kLeavesSome, 0, 20'000, limits); }),
            "the engine left too many pairs to the host; run fewer pairs at once");
}

TEST_F(EngineTest, StopsBeforeTheUndecidedPairsOverflow) {
  EngineLimits limits;
  limits.block_pairs = 512;
  const EngineResult whole = run(kLeavesSome, 0, 20'000, limits);
  ASSERT_GT(whole.undecided.size(), 2u);
  ASSERT_EQ(whole.done, 20'000u);
  limits.undecided = 512 + static_cast<std::uint32_t>(whole.undecided.size()) / 2;
  std::vector<std::uint64_t> counts(whole.counts.size()), undecided;
  int runs = 0;
  for (std::uint64_t done = 0; done < 20'000; ++runs) {
    const EngineResult part = run(kLeavesSome, done, 20'000 - done, limits);
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] += part.counts[k];
    undecided.insert(undecided.end(), part.undecided.begin(), part.undecided.end());
    done += part.done;
  }
  EXPECT_GT(runs, 1);
  EXPECT_EQ(counts, whole.counts);
  EXPECT_EQ(undecided, whole.undecided);
}

}  // namespace
}  // namespace graze::cuda
