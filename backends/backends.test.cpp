// SPDX-License-Identifier: Apache-2.0
#include "backends/backends.h"

#include <gtest/gtest.h>

namespace graze::backends {
namespace {

TEST(Backends, RunALaneOnTheHostOrSayWhyNot) {
  int here = 0, not_here = 0;
  for (const Lane& lane : lanes()) {
    const std::string why = why_not_on_host(lane);
    if (why.empty()) {
      EXPECT_TRUE(on_host(lane)) << lane.id;
      ++here;
    } else {
      EXPECT_TRUE(!on_host(lane) || why.find("instructions") != why.npos) << lane.id << ": " << why;
      ++not_here;
    }
  }
  EXPECT_GT(here, 0);
  EXPECT_GT(not_here, 0);  // cuda-fast has no twin
}

TEST(Backends, SayWhyNoDeviceRunsALaneWithoutTwin) {
  const Lane& lane = *find_lane("moller_1997/f32/cuda-fast");
  EXPECT_EQ(backend_of(lane).why_not_on_host(lane, "no device"), "no device, and no twin");
  const Lane& twin = *find_lane("moller_1997/f32/cuda-fma");
  EXPECT_EQ(backend_of(twin).why_not_on_host(twin, "no device"), "");
}

TEST(Backends, HaveAnExactLaneInTheSamePlace) {
  for (const Lane& lane : lanes()) {
    EXPECT_TRUE(exact_beside(lane).exact) << lane.id;
    EXPECT_EQ(&backend_of(exact_beside(lane)), &backend_of(lane)) << lane.id;
  }
}

TEST(Backends, NameTheEvidenceOfReplaysAlone) {
  for (const Lane& lane : lanes()) {
    if (!on_host(lane)) continue;
    EXPECT_EQ(backend_of(lane).evidence(lane, false).empty(), !backend_of(lane).is_replayed) << lane.id;
  }
}

TEST(Backends, TreatForeignCudaCodeAsAProcess) {
  Lane lane = *find_lane("moller_1997/f32/cuda-fma");
  lane.foreign = true;
  lane.evidence = "no nvcc";
  EXPECT_FALSE(backend_of(lane).has_device);
  EXPECT_EQ(why_not_on_host(lane), "no nvcc");
  lane.decide = find_lane("moller_1997/f32/cpu")->decide;
  EXPECT_EQ(why_not_on_host(lane), "");
  EXPECT_EQ(language_of(lane), Language::cuda);
}

}  // namespace
}  // namespace graze::backends
