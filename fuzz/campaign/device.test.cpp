// SPDX-License-Identifier: Apache-2.0
// Tests on devices: the GPU engine, the CPU engine with lanes on a device, and the CPU engine with twins must write the
// same bytes. This is a separate program, so that it can be copied to a GPU machine. Without a device its tests are
// skipped; with --require-device, or GRAZE_REQUIRE_DEVICE=1 in the environment, they fail instead.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "analysis/discrepancy.h"
#include "analysis/sweep.h"
#include "cuda/engine/discrepancy.h"
#include "cuda/lanes/device_costs.h"
#include "cuda/lanes/drawing_testing.h"
#include "cuda/twin/prove.h"
#include "fuzz/campaign/campaign_testing.h"
#include "strata/scene/file.h"
#include "strata/scene/sources.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

bool device_required = false;

class DeviceTest : public CampaignFiles {
 protected:
  void SetUp() override {
    std::string why_not;
    if (cuda::open_device(why_not)) {
      on_device_ = select_lanes(kWithTwins, Executor::device);
    } else if (device_required) {
      FAIL() << "a device is required, but: " << why_not;
    } else {
      GTEST_SKIP() << why_not;
    }
  }

  // engines: the number of devices that share the campaign; 0 means the CPU engine.
  Campaign campaign(const SelectedLanes& under_test, const std::string& name, std::uint64_t pairs, std::size_t engines,
                    std::uint64_t seed = 3, const std::vector<std::string>& strata = {}) const {
    Campaign c = campaign_of(under_test, strata::stratum_sources(seed, pairs, strata), seed, name);
    c.threads = 0;
    c.build = build_info(twins_);  // the same for all campaigns, so that summaries can be equal
    if (engines > 0) c.engines = cuda::open_engines(under_test.lanes);
    if (c.engines.size() < engines) throw std::runtime_error("expected more devices");
    c.engines.resize(engines);
    return c;
  }

  // Like `campaign`, but on all strata of doubles, or of both types.
  Campaign campaign_of_doubles(const SelectedLanes& under_test, const std::string& name, std::uint64_t pairs,
                               std::size_t engines = 0, PairTypes types = PairTypes::f64) const {
    Campaign c = campaign(under_test, name, 0, engines);
    c.sources = strata::stratum_sources(6, pairs, {}, types);
    return c;
  }

  const std::vector<std::string> kWithTwins = {"*/cuda-nofma", "*/cuda-fma", "*/cuda"};
  SelectedLanes twins_ = select_lanes(kWithTwins, Executor::twin);
  SelectedLanes on_device_;
};

#ifdef GRAZE_HAS_NVCC
// Compares the bits of every stratum of both types, without a scene and in a scene of each type.
TEST_F(DeviceTest, StrataHaveTheBitsOfTheHost) {
  constexpr std::uint32_t kPairs = 20'000;
  const std::vector<std::string> scenes = {
      "extent = [-7, 9]\nedges = [0.1, 2]",
      "coordinates = \"f64\"\nextent = [[500000, 500009], [0, 9], [0, 9]]\nedges = [0.01, 0.2]",
      "coordinates = \"f64\"\nextent = [-8, 8]\nedges = [0.1, 2]\ngrid = { decimals = 3 }"};
  std::vector<strata::PairSource> sources = strata::stratum_sources(5, 49, {}, PairTypes::both);
  for (const std::string& text : scenes) {
    const strata::SceneFile scene = strata::parse_scene("s", text);
    for (strata::PairSource& source :
         strata::scene_sources(scene, "", 5, 1'000, {}, scene.in_doubles ? PairTypes::f64 : PairTypes::f32).sources)
      sources.push_back(std::move(source));
  }
  int on_device = 0;
  for (const strata::PairSource& source : sources) {
    on_device += source.in_doubles() && source.stratum >= 0;
    const strata::PairBlock drawn = cuda::drawn_for_device(source, 7, kPairs),
                            expected = strata::pairs_of(source, 7, kPairs);
    const auto bytes = [](const auto& pairs) {
      return std::string_view(reinterpret_cast<const char*>(pairs.data()), pairs.size() * sizeof pairs[0]);
    };
    EXPECT_EQ(drawn.size(), kPairs);
    EXPECT_TRUE(bytes(drawn.floats) == bytes(expected.floats)) << source.id << (source.scene ? " in a scene" : "");
    EXPECT_TRUE(bytes(drawn.doubles) == bytes(expected.doubles)) << source.id << (source.scene ? " in a scene" : "");
  }
  EXPECT_GE(on_device, 27 + 2 * 15);  // all strata except `stored`
}
#endif

// Expects the same discrepancies on the device as on the host.   Returns: how many verdicts differ.
std::uint64_t verdicts_that_differ(analysis::DiscrepancySpec spec) {
  const analysis::Discrepancies on_host = analysis::discrepancies(spec);
  spec.on_device = true;
  EXPECT_EQ(analysis::discrepancies(spec), on_host) << spec.lanes[0].second->id;
  std::uint64_t verdicts = 0;
  for (const auto& of_lanes : on_host) {
    for (const analysis::DiscrepancyCounts& counts : of_lanes) verdicts += counts.counts[5];  // pair_counts::verdict
  }
  return verdicts;
}

TEST_F(DeviceTest, DiscrepanciesAreThoseOfTheHost) {
  std::uint64_t verdicts = 0;
  for (const Variant second : {Variant::cuda_fma, Variant::cuda_nofma}) {
    analysis::DiscrepancySpec spec;
    spec.sources = strata::stratum_sources(8, strata::kStrataCount * 700, {});
    for (const Lane& lane : published_lanes()) {
      if (lane.variant == Variant::cpu) spec.lanes.emplace_back(lane, *counterpart(lane, second));
    }
    verdicts += verdicts_that_differ(spec);
  }
  EXPECT_GT(verdicts, 1000u);
}

TEST_F(DeviceTest, DiscrepanciesOfDoublesAreThoseOfTheHost) {
  std::uint64_t verdicts = 0;
  for (const Variant second : {Variant::cuda_fma, Variant::cuda_nofma}) {
    analysis::DiscrepancySpec spec;
    spec.sources = strata::stratum_sources(8, 28 * 700, {}, PairTypes::f64);
    for (const Lane& lane : published_lanes()) {
      if (lane.variant == Variant::cpu && lane.scalar == Scalar::f64)
        spec.lanes.emplace_back(lane, *counterpart(lane, second));
    }
    std::uint64_t different = 0;
    for (const strata::PairSource& source : spec.sources)
      different += cuda::count_different_runs(*spec.lanes[0].first, *spec.lanes[0].second, source);
    EXPECT_EQ(different > 1000, second == Variant::cuda_fma) << different;
    EXPECT_EQ(different == 0, second == Variant::cuda_nofma) << different;
    verdicts += verdicts_that_differ(spec);
  }
  EXPECT_GT(verdicts, 100u);
}

// A host lane computes the same values as cuda-nofma, and count_different_runs finds a lane whose values differ.
TEST_F(DeviceTest, RunsThatDifferAreFound) {
  const strata::PairSource source = strata::stratum_sources(8, 50'000, {"thesis"})[0];
  const auto lane = [](const char* id) -> const Lane& { return *find_lane(id); };
  EXPECT_EQ(
      cuda::count_different_runs(lane("interval_overlap/f32/cpu"), lane("interval_overlap/f32/cuda-nofma"), source),
      0u);
  EXPECT_GT(cuda::count_different_runs(lane("interval_overlap/f32/cpu"), lane("interval_overlap/f32/cuda-fma"), source),
            20'000u);
}

TEST_F(DeviceTest, GpuEngineCpuEngineAndTwinsLeaveTheSameBytesOverAllStrata) {
  for (const std::uint64_t seed : {1, 20, 333}) {
    const std::string number = std::to_string(seed);
    run(campaign(twins_, "twins" + number, 60'007, 0, seed));
    run(campaign(on_device_, "cpu" + number, 60'007, 0, seed));
    const Json summary = run(campaign(on_device_, "gpu" + number, 60'007, 1, seed));
    expect_same_bytes("twins" + number, "cpu" + number);
    expect_same_bytes("twins" + number, "gpu" + number);
    EXPECT_GT(summary["signatures"].size(), 1000u);
  }
}

TEST_F(DeviceTest, DoublesAreDecidedAsByTheTwins) {
  select_for_doubles(twins_);
  select_for_doubles(on_device_);
  constexpr std::uint64_t kPairs = 28 * 5'000;
  run(campaign_of_doubles(twins_, "twins", kPairs));
  const Json summary = run(campaign_of_doubles(on_device_, "device", kPairs));
  expect_same_bytes("twins", "device");
  EXPECT_GT(summary["signatures"].size(), 1000u);
  run(campaign_of_doubles(on_device_, "engine", kPairs, 1));
  expect_same_bytes("twins", "engine");
  const Json timings = Json::parse(read_whole(root_ / "engine" / "timings.json"));
  EXPECT_GT(timings["oracle"]["exact"].get<std::uint64_t>(), kPairs * 95 / 100);  // the host judged few pairs
  // Lanes with fast math have no twin, so they decide doubles only on a device.
  SelectedLanes fast = select_lanes({"*/f64/cuda-fast", "moller_1997/f64/cpu-fma"}, Executor::device);
  EXPECT_TRUE(select_for_doubles(fast).empty());
  const Json counts = run(campaign_of_doubles(fast, "fast", kPairs))["strata"]["near_edge_edge/f64"]["lanes"];
  EXPECT_EQ(counts.size(), 6u) << counts;
}

// Sources of both coordinate types alternate on one engine, and runs end in the middle of a stratum.
TEST_F(DeviceTest, TheEngineTakesBothTypesInParts) {
  select_for_doubles(twins_);
  select_for_doubles(on_device_);
  const auto of_both = [&](const SelectedLanes& under_test, const std::string& name, std::size_t engines) {
    Campaign c = campaign_of_doubles(under_test, name, 49 * 501, engines, PairTypes::both);
    c.engine_batch = 333;
    return c;
  };
  run(of_both(twins_, "twins", 0));
  EXPECT_EQ(run_in_parts(of_both(on_device_, "engine", 1)), 49 * 2);
  expect_same_bytes("twins", "engine");
}

TEST_F(DeviceTest, LanesUnderTolerancesDecideDoublesAsTheirTwins) {
  const std::vector<std::string> globs = {"*/f64/cuda-nofma/abs:1e-9", "*/f64/cuda-nofma/rel:16",
                                          "*/f64/cuda-fma/abs:1e-9", "*/f64/cuda-fma/rel:16",
                                          "*/f64/cuda-fma/plane_distance=rel:3,separation=abs:1e-12"};
  SelectedLanes by_twins = select_lanes(globs, Executor::twin), on_device = select_lanes(globs, Executor::device);
  EXPECT_TRUE(select_for_doubles(by_twins).empty());
  EXPECT_TRUE(select_for_doubles(on_device).empty());
  ASSERT_EQ(by_twins.lanes.size(), globs.size() * 5);
  run(campaign_of_doubles(by_twins, "twins", 28 * 3'000));
  const Json summary = run(campaign_of_doubles(on_device, "device", 28 * 3'000));
  expect_same_bytes("twins", "device");
  EXPECT_GT(summary["signatures"].size(), 1000u);
}

TEST_F(DeviceTest, TwinsOfDoublesAreProven) {
  const cuda::ProofRecord record =
      cuda::prove_twin({.pairs = 28 * 40'000, .twin_pairs = 28 * 4'000, .of_doubles = true});
  EXPECT_EQ(record.lanes.size(), 10u);
  for (const cuda::LaneProof& lane : record.lanes) EXPECT_TRUE(lane.verified()) << lane.lane;
  const cuda::ProofRecord wrong = cuda::prove_twin(
      {.pairs = 28 * 40'000, .twin_pairs = 28, .of_doubles = true, .lanes = {"*/cuda-fma"}, .wrong_rule = true});
  EXPECT_EQ(wrong.lanes.size(), 5u);
  for (const cuda::LaneProof& lane : wrong.lanes) EXPECT_GT(lane.differences(), 0u) << lane.lane;
}

TEST_F(DeviceTest, ScenesAreDrawnOnTheDeviceAsOnTheHost) {
  const auto in_scenes = [&](const SelectedLanes& under_test, const std::string& name, bool engine) {
    Campaign c = campaign_of(under_test, sources_in_scenes(4, 120'000), 4, name);
    c.threads = 0;
    c.build = build_info(twins_);
    if (engine) c.engines = cuda::open_engines(under_test.lanes);
    return c;
  };
  run(in_scenes(twins_, "twins", false));
  run(in_scenes(on_device_, "cpu", false));
  const Json summary = run(in_scenes(on_device_, "gpu", true));
  expect_same_bytes("twins", "cpu");
  expect_same_bytes("twins", "gpu");
  EXPECT_GT(summary["signatures"].size(), 1000u);
}

TEST_F(DeviceTest, SweepsCountAsTheTwinsDo) {
  std::vector<strata::PairSource> sources = sources_in_scenes(5, 60'000);
  for (strata::PairSource& source : strata::stratum_sources(5, 120'000, {}, PairTypes::both))
    sources.push_back(std::move(source));
  const std::vector<std::string> policies = {"", "abs:1e-6", "rel:1", "rel:64", "rel:1e9", "plane_distance=abs:1e-3"};
  for (const char* id : {"moller_1997/f32/cuda-fma", "guigue_devillers_2003/f64/cuda-nofma"}) {
    const Lane& lane = *find_lane(id);
    const auto there = analysis::device_sweep(
        [&](const std::string& policy) { return policy.empty() ? lane : lane_under(lane, policy); })(policies, sources);
    EXPECT_EQ(there, analysis::host_sweep(lane)(policies, sources)) << id;
    EXPECT_GT(there[1].fixed + there[1].broken, 100u);
  }
  std::erase_if(sources, [](const strata::PairSource& source) { return source.in_doubles(); });
  const Lane& filtered = *find_lane("guigue_devillers_2003/f32/cuda-fma");
  const auto found = analysis::device_sweep([&](const std::string& policy) {
    return policy.empty() ? filtered : lane_under(filtered, policy);
  })(std::vector<std::string>{"filtered", "bound"}, sources);
  EXPECT_EQ(found[0].wrong() + found[0].declined + found[1].wrong(), 0u);
  EXPECT_GT(found[1].declined, 1000u);
}

// No lane with certified bounds is wrong on doubles whose determinants stay within a double's range.
TEST_F(DeviceTest, BoundsAndFiltersHoldOnDoubles) {
  const std::vector<strata::PairSource> sources =
      strata::stratum_sources(5, 400'000, {"near_*", "uniform", "large_offset", "lattice*"}, PairTypes::f64);
  for (const char* id : {"guigue_devillers_2003/f64/cuda-fma", "guigue_devillers_2003/f64/cuda-nofma"}) {
    const Lane& lane = *find_lane(id);
    const auto found = analysis::device_sweep([&](const std::string& policy) {
      return policy.empty() ? lane : lane_under(lane, policy);
    })(std::vector<std::string>{"filtered", "bound"}, sources);
    EXPECT_EQ(found[0].wrong() + found[0].declined + found[1].wrong(), 0u) << id;
    EXPECT_GT(found[1].declined, 1000u) << id;
  }
}

TEST_F(DeviceTest, CostsAreOfEachLaneAndNameItsKernel) {
  const Lane bound = lane_under(*find_lane("moller_1997/f64/cuda-fma"), "filtered");
  const Lane* lanes[] = {find_lane("moller_1997/f32/cuda-fma"), find_lane("exact/f64/cuda"), &bound};
  for (const PairTypes type : {PairTypes::f32, PairTypes::f64}) {
    const auto source = strata::stratum_sources(1, 1u << 20, {"near_edge_edge"}, type).front();
    const cuda::DeviceCosts costs = cuda::measure_on_device(lanes, strata::pairs_of(source, 0, source.pairs), 5);
    ASSERT_EQ(costs.of.size(), 3u);
    EXPECT_GE(costs.threads_at_once, 1024);
    for (const cuda::DeviceCost& cost : costs.of) {
      ASSERT_EQ(cost.resident.size(), 5u);
      for (std::size_t pass = 0; pass < 5; ++pass) {
        EXPECT_GT(cost.resident[pass], 0);
        EXPECT_GT(cost.with_copies[pass], 0.1);  // 72 bytes at 720 GB/s, faster than any link
      }
      EXPECT_GT(cost.needs.registers, 15);
      EXPECT_GT(cost.needs.active_threads, 0);
    }
    EXPECT_GT(costs.of[2].needs.registers, costs.of[0].needs.registers);
  }
}

TEST_F(DeviceTest, LanesUnderTolerancesLeaveTheSameBytesByTheirTwins) {
  const std::vector<std::string> globs = {"*/cuda-nofma/abs:1e-6", "*/cuda-nofma/rel:16", "*/cuda-fma/abs:1e-6",
                                          "*/cuda-fma/rel:16", "*/cuda-fma/plane_distance=rel:3,separation=abs:1e-9"};
  const SelectedLanes asked = select_lanes(globs, Executor::twin);
  ASSERT_EQ(asked.lanes.size(), globs.size() * 10 - 2);  // two lanes have no twin: see twin.cpp
  std::vector<std::string> ids;
  for (const Lane* lane : asked.lanes) ids.push_back(lane->id);
  const SelectedLanes by_twins = select_lanes(ids, Executor::twin), by_device = select_lanes(ids, Executor::device);
  run(campaign(by_twins, "twins", 60'007, 0));
  run(campaign(by_device, "cpu", 60'007, 0));
  const Json summary = run(campaign(by_device, "gpu", 60'007, 1));
  expect_same_bytes("twins", "cpu");
  expect_same_bytes("twins", "gpu");
  EXPECT_GT(summary["signatures"].size(), 1000u);
}

TEST_F(DeviceTest, BoundsDecideNothingWrongly) {
  const SelectedLanes lanes =
      select_lanes({"*/cuda-nofma/bound", "*/cuda-fma/bound", "*/cuda-fma/filtered"}, Executor::device);
  ASSERT_EQ(lanes.lanes.size(), 3u * 4 * 2);
  const Json summary = run(campaign(lanes, "bounds", 200'003, 1));
  std::uint64_t declined = 0;
  for (const auto& [stratum, row] : summary["strata"].items()) {
    for (const auto& [lane, counts] : row["lanes"].items()) {
      EXPECT_EQ(counts["false_positive"], 0) << lane << " " << stratum;
      EXPECT_EQ(counts["false_negative"], 0) << lane << " " << stratum;
      if (lane.ends_with("filtered")) {
        EXPECT_EQ(counts["declined"], 0) << lane << " " << stratum;
      }
      declined += counts["declined"].get<std::uint64_t>();
    }
  }
  EXPECT_GT(declined, 10'000u);
  EXPECT_EQ(summary["disagreements"], 0);  // declined is not wrong
  EXPECT_TRUE(summary["signatures"].empty());
}

TEST_F(DeviceTest, BothEnginesLeaveTheSameBytesOfLanesWithoutATwin) {
  const SelectedLanes all = select_lanes({"*/cuda*"}, Executor::device);
  ASSERT_GT(all.lanes.size(), on_device_.lanes.size());
  run(campaign(all, "cpu", 30'011, 0));
  run(campaign(all, "gpu", 30'011, 1));
  expect_same_bytes("cpu", "gpu");
}

TEST_F(DeviceTest, OddCountsLeaveTheSameBytes) {
  for (const std::uint64_t pairs : {1, 31, 33, 257, 1'023}) {
    const std::string number = std::to_string(pairs);
    run(campaign(twins_, "twins" + number, pairs, 0, 3, {"degenerate"}));
    run(campaign(on_device_, "gpu" + number, pairs, 1, 3, {"degenerate"}));
    expect_same_bytes("twins" + number, "gpu" + number);
  }
}

TEST_F(DeviceTest, InterruptionsInTheMiddleOfAStratumChangeNothing) {
  run(campaign(twins_, "twins", 30'011, 0));
  Campaign parts = campaign(on_device_, "parts", 30'011, 1);
  parts.engine_batch = 701;  // a stratum has 1429 or 1430 pairs
  EXPECT_EQ(run_in_parts(parts), strata::kStrataCount * 3);
  expect_same_bytes("twins", "parts");
}

// Judges seven blocks, more pairs than memory holds at once, and compares the bytes with those of three shorter runs.
TEST_F(DeviceTest, ManyBlocksCountAsManyRuns) {
  constexpr std::uint64_t kPairs = (std::uint64_t{7} << 22) - 12'345;
  for (const char* stratum : {"near_edge_edge", "extreme_scale"}) {
    const std::string name = stratum;
    run(campaign(on_device_, name, kPairs, 1, 3, {name}));
    Campaign parts = campaign(on_device_, name + "-parts", kPairs, 1, 3, {name});
    parts.engine_batch = 10'000'019;
    EXPECT_EQ(run_in_parts(parts), 3);
    expect_same_bytes(name, name + "-parts");
  }
}

TEST_F(DeviceTest, TwoDevicesLeaveTheBytesOfOne) {
  const std::size_t devices = cuda::open_engines(on_device_.lanes).size();
  if (devices < 2) GTEST_SKIP() << "there is only one device";
  run(campaign(twins_, "twins", 30'011, 0));
  run(campaign(on_device_, "one", 30'011, 1));
  run(campaign(on_device_, "two", 30'011, 2));
  Campaign parts = campaign(on_device_, "parts", 30'011, 2);
  parts.engine_batch = 401;
  EXPECT_EQ(run_in_parts(parts), strata::kStrataCount * 2);
  for (const char* name : {"one", "two", "parts"}) expect_same_bytes("twins", name);
}

TEST_F(DeviceTest, TakesAnyNumberOfLanes) {
  ManyLanes on_host(twins_, 9), on_device(on_device_, 9);  // 36 lanes of each algorithm need five chunks of the tally
  std::string why_not;
  on_device.under_test.device = cuda::open_device(why_not);
  run(campaign(on_host.under_test, "twins", 4'001, 0));
  run(campaign(on_device.under_test, "gpu", 4'001, 1));
  expect_same_bytes("twins", "gpu");
}

}  // namespace
}  // namespace graze::fuzz

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const char* const variable = std::getenv("GRAZE_REQUIRE_DEVICE");
  graze::fuzz::device_required = variable && std::strcmp(variable, "1") == 0;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) != "--require-device") {
      std::fprintf(stderr, "expected --require-device or GoogleTest options, found '%s'\n", argv[i]);
      return 2;
    }
    graze::fuzz::device_required = true;
  }
  return RUN_ALL_TESTS();
}
