// SPDX-License-Identifier: Apache-2.0
// Tests the GPU engine without a GPU. Its steps run on this processor, and the campaign must give the same bytes as
// with the CPU engine. device.test.cpp makes the same comparison on devices.
#include "fuzz/campaign/gpu_engine.h"

#include "core/message_testing.h"
#include "cuda/engine/host_engine_testing.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/changed_verdicts.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

class GpuEngineTest : public CampaignFiles {
 protected:
  Campaign campaign(const SelectedLanes& under_test, const std::string& name, std::uint64_t pairs, int engines,
                    std::uint64_t seed = 3, const std::vector<std::string>& strata = {},
                    const cuda::EngineLimits& limits = {}) const {
    Campaign c = campaign_of(under_test, strata::stratum_sources(seed, pairs, strata), seed, name);
    for (int e = 0; e < engines; ++e)
      c.engines.push_back(cuda::make_host_engine(under_test.lanes, under_test.on_host, limits));
    return c;
  }

  SelectedLanes twins_ = select_lanes({"*/cuda*"}, Executor::twin);
};

TEST_F(GpuEngineTest, LeavesTheBytesOfTheCpuEngineOverAllStrata) {
  for (const std::uint64_t seed : {1, 2, 77}) {
    const std::string cpu = "cpu" + std::to_string(seed), engine = "engine" + std::to_string(seed);
    run(campaign(twins_, cpu, 15'007, 0, seed));
    const Json summary = run(campaign(twins_, engine, 15'007, 1, seed));
    expect_same_bytes(cpu, engine);
    EXPECT_GT(summary["signatures"].size(), 500u);
    const Json timings = Json::parse(read_whole(root_ / engine / "timings.json"));
    EXPECT_GT(timings["oracle"]["exact"].get<std::uint64_t>(), 14'000u);  // the steps decided most pairs
  }
}

// The GPU engine computes no digests, and equal counts do not prove that its verdicts are the CPU engine's.
TEST_F(GpuEngineTest, ItsVerdictsAreNotProvedToBeTheSame) {
  run(campaign(twins_, "cpu", 3'000, 0, 3, {"degenerate"}));
  run(campaign(twins_, "again", 3'000, 0, 3, {"degenerate"}));
  run(campaign(twins_, "engine", 3'000, 1, 3, {"degenerate"}));
  using enum ChangedVerdicts::Known;
  const auto found = [&](const char* name) { return changed_verdicts(root_ / "cpu", root_ / name); };
  std::size_t not_known = 0;
  for (const ChangedVerdicts& row : found("engine")) {
    EXPECT_NE(row.known, changed) << row.lane;
    EXPECT_EQ(row.least, 0u);
    EXPECT_EQ(row.most > 0, row.known == ChangedVerdicts::Known::unknown);
    not_known += row.known == ChangedVerdicts::Known::unknown;
  }
  EXPECT_GT(not_known, twins_.lanes.size() / 2);
  for (const ChangedVerdicts& row : found("again")) EXPECT_EQ(row.known, same) << row.lane;
}

TEST_F(GpuEngineTest, LeavesTheBytesOfTheCpuEngineInScenes) {
  for (const int engines : {0, 1}) {
    Campaign c = campaign_of(twins_, sources_in_scenes(4, 12'000), 4, engines ? "engine" : "cpu");
    if (engines) c.engines.push_back(cuda::make_host_engine(twins_.lanes, twins_.on_host));
    EXPECT_GT(c.sources.size(), 40u);
    EXPECT_GT(run(c)["signatures"].size(), 300u);
  }
  expect_same_bytes("cpu", "engine");
}

TEST_F(GpuEngineTest, TwoEnginesAndInterruptionsChangeNothing) {
  const std::vector<std::string> strata = {"degenerate", "extreme_scale", "mixed_scale"};
  run(campaign(twins_, "cpu", 3'001, 0, 3, strata));
  cuda::EngineLimits limits;
  limits.block_pairs = 100;
  limits.undecided = 101;  // makes runs end early
  Campaign parts = campaign(twins_, "parts", 3'001, 2, 3, strata, limits);
  parts.engine_batch = 77;  // 154 for two engines; a stratum has 1000 or 1001 pairs
  EXPECT_EQ(run_in_parts(parts), 3 * 7);
  expect_same_bytes("cpu", "parts");
}

TEST_F(GpuEngineTest, TakesAnyNumberOfLanes) {
  const ManyLanes many(twins_, 9);  // 36 lanes of each algorithm
  ASSERT_GT(many.under_test.lanes.size(), 128u);
  run(campaign(many.under_test, "cpu", 2'003, 0));
  run(campaign(many.under_test, "engine", 2'003, 1));
  expect_same_bytes("cpu", "engine");
}

TEST_F(GpuEngineTest, SaysWhenItsMemoryIsNotEnough) {
  const auto error = [&](const std::string& name, const cuda::EngineLimits& limits) {
    return error_of([&] { run(campaign(twins_, name, 20'000, 1, 3, {"mixed_scale"}, limits)); });
  };
  cuda::EngineLimits few;
  few.signatures = 16;
  EXPECT_EQ(error("signatures", few), "the engine found more signatures than its table has rows");
  few = {};
  few.undecided = 1;
  EXPECT_EQ(error("undecided", few), "the engine left too many pairs to the host; run fewer pairs at once");
  EXPECT_EQ(error("enough", {}), "");
}

// This engine counts one right verdict of a lane as wrong.
class WrongEngine final : public cuda::DeviceEngine {
 public:
  explicit WrongEngine(std::unique_ptr<cuda::DeviceEngine> engine) : engine_(std::move(engine)) {}

  cuda::EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) override {
    cuda::EngineResult result = engine_->run(source, first, count);
    Verdict& verdict = result.signatures.at(result.signatures.size() / 2).verdicts.back();
    verdict = verdict == Verdict::intersects ? Verdict::disjoint : Verdict::intersects;
    return result;
  }

 private:
  std::unique_ptr<cuda::DeviceEngine> engine_;
};

TEST_F(GpuEngineTest, TheOracleFindsAnEngineThatIsWrongOnOneSignature) {
  Campaign c = campaign(twins_, "wrong", 5'000, 1, 3, {"sliver"});
  c.engines[0] = std::make_unique<WrongEngine>(std::move(c.engines[0]));
  EXPECT_THROW(run(c), oracle::OracleMismatch);
}

// Double-precision lanes decide the doubles; single-precision lanes decide the pairs rounded to float32.
class GpuEngineOnDoubles : public GpuEngineTest {
 protected:
  GpuEngineOnDoubles() { select_for_doubles(twins_); }

  Campaign of_doubles(const std::string& name, std::uint64_t pairs, int engines,
                      const std::vector<std::string>& strata = {}, PairTypes types = PairTypes::f64,
                      const cuda::EngineLimits& limits = {}) const {
    Campaign c = campaign(twins_, name, 1, engines, 3, {"uniform"}, limits);
    c.sources = strata::stratum_sources(3, pairs, strata, types);
    c.spec = campaign_spec(c);
    return c;
  }
};

TEST_F(GpuEngineOnDoubles, LeavesTheBytesOfTheCpuEngineOverAllStrata) {
  constexpr std::uint64_t kPairsOfDoubles = 28 * 400 + 7;
  run(of_doubles("cpu", kPairsOfDoubles, 0));
  const Json summary = run(of_doubles("engine", kPairsOfDoubles, 1));
  expect_same_bytes("cpu", "engine");
  EXPECT_GT(summary["signatures"].size(), 1000u);
  std::uint64_t stored = 0, signatures_of_exact = 0;
  for (const auto& [stratum, row] : summary["strata"].items())
    stored += row["lanes"]["exact/f32/cuda"]["stored"].get<std::uint64_t>();
  for (const Json& row : summary["signatures"])
    signatures_of_exact += row["key"].get<std::string>().find("exact:") != std::string::npos;
  EXPECT_GT(stored, 1000u);
  EXPECT_GT(signatures_of_exact, 50u);
  const Json timings = Json::parse(read_whole(root_ / "engine" / "timings.json"));
  EXPECT_GT(timings["oracle"]["exact"].get<std::uint64_t>(),
            kPairsOfDoubles * 95 / 100);  // the steps decided nearly all pairs
}

TEST_F(GpuEngineOnDoubles, BothTypesTwoEnginesAndInterruptionsChangeNothing) {
  const std::vector<std::string> strata = {"degenerate", "extreme_scale", "mixed_scale", "far_from_origin", "stored"};
  run(of_doubles("cpu", 9 * 200, 0, strata, PairTypes::both));
  cuda::EngineLimits limits;
  limits.block_pairs = 30;
  limits.signatures = 1u << 10;
  limits.undecided = 31;  // makes runs end early
  Campaign parts = of_doubles("parts", 9 * 200, 2, strata, PairTypes::both, limits);
  ASSERT_EQ(parts.sources.size(), 9u);
  parts.engine_batch = 77;  // 154 for two engines; a stratum has 200 pairs
  EXPECT_EQ(run_in_parts(parts), 9 * 2);
  expect_same_bytes("cpu", "parts");
}

TEST_F(GpuEngineOnDoubles, LeavesTheBytesOfTheCpuEngineInAScene) {
  const auto scene =
      strata::parse_scene("s", "extent = [[120000, 120800], [-5400, -5000], [300, 900]]\nedges = [0.5, 40]");
  for (const int engines : {0, 1}) {
    Campaign c = of_doubles(engines ? "engine" : "cpu", 1, engines, {"uniform"});
    c.sources = strata::scene_sources(scene, "", 4, 3'000, {}, PairTypes::f64).sources;
    c.spec = campaign_spec(c);
    ASSERT_TRUE(c.sources.front().in_doubles());
    EXPECT_GT(run(c)["signatures"].size(), 300u);
  }
  expect_same_bytes("cpu", "engine");
}

TEST_F(GpuEngineOnDoubles, OddCountsLeaveTheSameBytes) {
  for (const std::uint64_t pairs : {1, 31, 33, 65, 257}) {
    const std::string number = std::to_string(pairs);
    run(of_doubles("cpu" + number, pairs, 0, {"stored"}));
    run(of_doubles("engine" + number, pairs, 1, {"stored"}));
    expect_same_bytes("cpu" + number, "engine" + number);
  }
}

TEST_F(GpuEngineOnDoubles, TheOracleFindsAnEngineThatIsWrongOnOneSignature) {
  Campaign c = of_doubles("wrong", 2'000, 1, {"near_edge_edge"});
  c.engines[0] = std::make_unique<WrongEngine>(std::move(c.engines[0]));
  EXPECT_THROW(run(c), oracle::OracleMismatch);
}

}  // namespace
}  // namespace graze::fuzz
