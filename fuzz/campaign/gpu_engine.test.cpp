// SPDX-License-Identifier: Apache-2.0
// The GPU engine without a GPU. Its steps run on this processor, and the campaign must leave the same bytes as the CPU
// engine. device.test.cpp tests the same on devices.
#include "fuzz/campaign/gpu_engine.h"

#include "cuda/engine/host_engine.h"
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
    EXPECT_GT(timings["oracle"]["exact"].get<std::uint64_t>(), 14'000u);  // the steps decided nearly all
  }
}

// A device's engine keeps no digests, so equal counts do not prove that its verdicts are those of the CPU engine.
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
  limits.undecided = 101;  // so that runs end early
  Campaign parts = campaign(twins_, "parts", 3'001, 2, 3, strata, limits);
  parts.engine_batch = 77;  // 154 out of a stratum's 1000 or 1001 pairs
  EXPECT_EQ(run_in_parts(parts), 3 * 7);
  expect_same_bytes("cpu", "parts");
}

TEST_F(GpuEngineTest, TakesAnyNumberOfLanes) {
  const ManyLanes many(twins_, 9);  // 36 of each algorithm
  ASSERT_GT(many.under_test.lanes.size(), 128u);
  run(campaign(many.under_test, "cpu", 2'003, 0));
  run(campaign(many.under_test, "engine", 2'003, 1));
  expect_same_bytes("cpu", "engine");
}

TEST_F(GpuEngineTest, SaysWhenItsMemoryIsNotEnough) {
  const auto error = [&](const std::string& name, const cuda::EngineLimits& limits) -> std::string {
    try {
      run(campaign(twins_, name, 20'000, 1, 3, {"mixed_scale"}, limits));
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  cuda::EngineLimits few;
  few.signatures = 16;
  EXPECT_EQ(error("signatures", few), "the engine found more signatures than it can hold");
  few = {};
  few.undecided = 1;
  EXPECT_EQ(error("undecided", few), "the engine left too many pairs to the host; run fewer at once");
  EXPECT_EQ(error("enough", {}), "");
}

// An engine that takes one lane's right verdict for a wrong one.
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

}  // namespace
}  // namespace graze::fuzz
