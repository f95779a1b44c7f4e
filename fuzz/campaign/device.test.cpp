// SPDX-License-Identifier: Apache-2.0
// Devices: the GPU engine, the CPU engine with lanes on a device, and the CPU engine with their twins leave the same
// bytes. A program of its own, to be carried to a GPU machine. Without a device its tests are skipped; with
// --require-device, or GRAZE_REQUIRE_DEVICE=1 in the environment, they fail.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "fuzz/campaign/campaign_testing.h"

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
      FAIL() << "a device is required, found: " << why_not;
    } else {
      GTEST_SKIP() << why_not;
    }
  }

  // engines: how many devices share it; 0: the CPU engine.
  Campaign campaign(const LanesUnderTest& under_test, const std::string& name, std::uint64_t pairs, std::size_t engines,
                    std::uint64_t seed = 3, const std::vector<std::string>& strata = {}) const {
    Campaign c = campaign_of(under_test, strata::stratum_sources(seed, pairs, strata), seed, name);
    c.threads = 0;
    c.build = build_info(twins_);  // one for all, so that their summaries can be the same
    if (engines > 0) c.engines = cuda::open_engines(under_test.lanes);
    if (c.engines.size() < engines) throw std::runtime_error("expected more devices");
    c.engines.resize(engines);
    return c;
  }

  const std::vector<std::string> kWithTwins = {"*/cuda-nofma", "*/cuda-fma", "*/cuda"};
  LanesUnderTest twins_ = select_lanes(kWithTwins, Executor::twin);
  LanesUnderTest on_device_;
};

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

TEST_F(DeviceTest, LanesUnderTolerancesLeaveTheSameBytesByTheirTwins) {
  const std::vector<std::string> globs = {"*/cuda-nofma/abs:1e-6", "*/cuda-nofma/rel:16", "*/cuda-fma/abs:1e-6",
                                          "*/cuda-fma/rel:16", "*/cuda-fma/plane_distance=rel:3,separation=abs:1e-9"};
  const LanesUnderTest by_twins = select_lanes(globs, Executor::twin);
  ASSERT_EQ(by_twins.lanes.size(), globs.size() * 10 - 2);  // two have none: see twin.cpp
  std::vector<std::string> ids;
  for (const Lane* lane : by_twins.lanes) ids.push_back(lane->id);
  const LanesUnderTest by_device = select_lanes(ids, Executor::device);
  run(campaign(by_twins, "twins", 60'007, 0));
  run(campaign(by_device, "cpu", 60'007, 0));
  const Json summary = run(campaign(by_device, "gpu", 60'007, 1));
  expect_same_bytes("twins", "cpu");
  expect_same_bytes("twins", "gpu");
  EXPECT_GT(summary["signatures"].size(), 1000u);
}

TEST_F(DeviceTest, BoundsDecideNothingWrongly) {
  const LanesUnderTest lanes =
      select_lanes({"*/cuda-nofma/bound", "*/cuda-fma/bound", "*/cuda-fma/filtered"}, Executor::device);
  ASSERT_EQ(lanes.lanes.size(), 3u * 4 * 2);
  const Json summary = run(campaign(lanes, "bounds", 200'003, 1));
  std::uint64_t declined = 0;
  for (const auto& [stratum, row] : summary["strata"].items()) {
    for (const auto& [lane, counts] : row["lanes"].items()) {
      EXPECT_EQ(counts["false_positive"], 0) << lane << " " << stratum;
      EXPECT_EQ(counts["false_negative"], 0) << lane << " " << stratum;
      if (lane.ends_with("filtered")) EXPECT_EQ(counts["declined"], 0) << lane << " " << stratum;
      declined += counts["declined"].get<std::uint64_t>();
    }
  }
  EXPECT_GT(declined, 10'000u);
}

TEST_F(DeviceTest, BothEnginesLeaveTheSameBytesOfLanesWithoutATwin) {
  const LanesUnderTest all = select_lanes({"*/cuda*"}, Executor::device);
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
  parts.engine_batch = 701;  // of a stratum's 1579 or 1580
  EXPECT_EQ(run_in_parts(parts), 19 * 3);
  expect_same_bytes("twins", "parts");
}

// More pairs than there is memory for at once: seven blocks, and runs that share none of their borders.
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
  if (devices < 2) GTEST_SKIP() << "one device only";
  run(campaign(twins_, "twins", 30'011, 0));
  run(campaign(on_device_, "one", 30'011, 1));
  run(campaign(on_device_, "two", 30'011, 2));
  Campaign parts = campaign(on_device_, "parts", 30'011, 2);
  parts.engine_batch = 401;
  EXPECT_EQ(run_in_parts(parts), 19 * 2);
  for (const char* name : {"one", "two", "parts"}) expect_same_bytes("twins", name);
}

TEST_F(DeviceTest, TakesAnyNumberOfLanes) {
  ManyLanes on_host(twins_, 9), on_device(on_device_, 9);  // 36 of an algorithm, five chunks of the tally
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
      std::fprintf(stderr, "expected --require-device or options of GoogleTest, found '%s'\n", argv[i]);
      return 2;
    }
    graze::fuzz::device_required = true;
  }
  return RUN_ALL_TESTS();
}
