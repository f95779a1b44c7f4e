// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/prove.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cuda/lanes/device.h"

namespace graze::cuda {
namespace {

TEST(ProveTwin, FindsNoDifference) {
  if (std::string why; !open_device(why)) GTEST_SKIP() << why;
  const ProofRecord record = prove_twin({.pairs = 2'000'000, .twin_pairs = 200'000});
  for (const LaneProof& lane : record.lanes) EXPECT_TRUE(lane.verified()) << lane.lane;
  EXPECT_EQ(record.lanes.size(), 20u);
}

TEST(ProveTwin, CatchesTheRightProductFirst) {
  if (std::string why; !open_device(why)) GTEST_SKIP() << why;
  const ProofRecord record =
      prove_twin({.pairs = 2'000'000, .twin_pairs = 20'000, .lanes = {"*/cuda-fma"}, .wrong_rule = true});
  for (const LaneProof& lane : record.lanes) EXPECT_GT(lane.differences(), 0u) << lane.lane;
}

TEST(ProofRecord, NeedsPairsAndNoDifference) {
  ProofRecord record;
  record.lanes = {{"lane", "hash", "trace", {{"uniform", 10, 0, 0, 5, 0, 0}}}};
  EXPECT_TRUE(record.verified());
  record.lanes[0].strata[0].twin_trace_differences = 1;
  EXPECT_FALSE(record.verified());
  record.lanes[0].strata[0] = {"uniform", 10, 0, 0, 0, 0, 0};
  EXPECT_FALSE(record.verified());
  EXPECT_FALSE(ProofRecord{}.verified());
}

TEST(ProofRecord, IsWrittenInFull) {
  ProofRecord record;
  record.device = "GPU";
  record.lanes = {{"lane", "h", "t", {{"uniform", 10, 1, 2, 5, 3, 4}}}};
  const auto json = to_json(record);
  EXPECT_EQ(json["device"], "GPU");
  EXPECT_EQ(json["lanes"][0]["differences"], 3);
  EXPECT_EQ(json["lanes"][0]["twin_differences"], 7);
  EXPECT_EQ(json["lanes"][0]["strata"][0]["trace_differences"], 2);
}

}  // namespace
}  // namespace graze::cuda
