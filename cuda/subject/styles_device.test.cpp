// SPDX-License-Identifier: Apache-2.0
// Compares device and twin for every style and variant, on GRAZE_PAIRS pairs from all strata (default: one million).
// `cmake --build … --target graze_device_styles` makes the builds, in the folder `styles` next to this program.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "cuda/lanes/device.h"
#include "cuda/subject/styles_testing.h"
#include "cuda/subject/subject_device.h"

namespace graze::cuda {
namespace {

class StylesOnADevice : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string why; !open_device(why)) GTEST_SKIP() << why;
    styles_ = read_styles(std::filesystem::read_symlink("/proc/self/exe").parent_path() / "styles");
    if (styles_.empty()) GTEST_SKIP() << "no builds beside this program: build the target graze_device_styles";
  }
  std::vector<StyleBuild> styles_;
};

TEST_F(StylesOnADevice, EqualTheirTwins) {
  const char* wanted = std::getenv("GRAZE_PAIRS");
  const std::uint64_t pairs = wanted ? parse_whole(wanted).value() : 1'000'000;
  std::vector<NamedBuild> builds;
  for (const StyleBuild& style : styles_) builds.push_back({style.name, &style.build});
  const ProofRecord record = prove_subjects(
      builds, {.twin_pairs = pairs, .progress = [](const std::string& line) { std::cout << line << "\n"; }});
  EXPECT_GE(record.lanes.size(), 17u * 3);
  for (const LaneProof& lane : record.lanes) {
    EXPECT_TRUE(lane.verified()) << lane.lane << ": " << lane.twin_differences() << " of " << lane.twin_pairs();
    EXPECT_EQ(lane.twin_pairs(), pairs) << lane.lane;
    for (const StratumProof& row : lane.strata) {
      for (const std::uint64_t index : row.examples)
        std::cout << lane.lane << ": differs on " << row.stratum << " " << index << "\n";
    }
  }
  if (const char* file = std::getenv("GRAZE_PROOF")) {  // the file for the proof record
    EXPECT_TRUE((std::ofstream(file) << to_json(record).dump(1) << "\n").flush());
  }
}

TEST_F(StylesOnADevice, EqualTheirTwinsOnDoubles) {
  std::vector<NamedBuild> builds;
  for (const StyleBuild& style : styles_) builds.push_back({style.name, &style.build});
  const ProofRecord record = prove_subjects(builds, {.twin_pairs = 1'000'000, .of_doubles = true});
  ASSERT_GE(record.lanes.size(), 3u);
  for (const LaneProof& lane : record.lanes) {
    EXPECT_NE(lane.lane.find("/f64/"), std::string::npos) << lane.lane;
    EXPECT_TRUE(lane.verified()) << lane.lane << ": " << lane.twin_differences() << " of " << lane.twin_pairs();
    EXPECT_EQ(lane.strata.size(), 28u);
  }
}

TEST_F(StylesOnADevice, AWrongTwinShows) {  // the wrong twin is another variant's
  const auto of = [&](const std::string& name) {
    for (const StyleBuild& style : styles_) {
      if (style.name == name) return style.build;
    }
    throw std::runtime_error("no build of the style " + name);
  };
  CudaBuild build = of("edge_loops/f32/cuda-fma");
  build.twin = of("edge_loops/f32/cuda-nofma").twin;
  const NamedBuild builds[] = {{"wrong", &build}};
  EXPECT_GT(prove_subjects(builds, {.twin_pairs = 1'000'000}).lanes.at(0).twin_differences(), 0u);
}

}  // namespace
}  // namespace graze::cuda
