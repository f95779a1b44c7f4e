// SPDX-License-Identifier: Apache-2.0
// Campaigns in a folder of their own, for tests that compare what they leave.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/result_files.h"

namespace graze::fuzz {

// Everything that a campaign leaves and that must not depend on how it ran.
inline std::map<std::string, std::string> lasting_files(const std::filesystem::path& directory) {
  std::map<std::string, std::string> files{{"summary.json", read_whole(directory / "summary.json")}};
  for (const auto& file : std::filesystem::directory_iterator(directory / "cases"))
    files[file.path().filename()] = read_whole(file.path());
  return files;
}

class CampaignFiles : public testing::Test {
 protected:
  CampaignFiles() {
    root_ = std::filesystem::temp_directory_path() / ("graze-campaign-" + std::to_string(getpid()));
    std::filesystem::remove_all(root_);
  }
  ~CampaignFiles() override { std::filesystem::remove_all(root_); }

  Campaign campaign_of(const LanesUnderTest& under_test, std::vector<strata::PairSource> sources, std::uint64_t seed,
                       const std::string& name) const {
    Campaign c;
    c.seed = seed;
    c.sources = std::move(sources);
    c.under_test = &under_test;
    c.threads = 2;
    c.directory = root_ / name;
    c.spec = campaign_spec(c);
    c.build = build_info(under_test);
    return c;
  }

  // Runs so many batches of the campaign.   Returns: its summary.
  Json run(const Campaign& c, std::uint64_t stop_after_batches = ~0ull) const {
    std::atomic<bool> stop{false};
    std::uint64_t batches = 0;
    return run_campaign(c, stop, [&](const Progress&) { stop = ++batches >= stop_after_batches; }).summary;
  }

  // Interrupts the campaign after every batch until it is done.   Returns: how often.
  int run_in_parts(const Campaign& c) const {
    int parts = 1;
    while (!run(c, 1)["complete"].get<bool>()) ++parts;
    return parts;
  }

  // The same, but for what ran the lanes, which the build says.
  void expect_same_bytes(const std::string& one, const std::string& other) const {
    const auto files = lasting_files(root_ / one), others = lasting_files(root_ / other);
    EXPECT_EQ(files.size(), others.size()) << one << " and " << other << " keep other cases";
    for (const auto& [name, text] : files) {
      const auto found = others.find(name);
      ASSERT_NE(found, others.end()) << name << " of " << one << " is not in " << other;
      EXPECT_TRUE(text == found->second) << name << " of " << one << " differs in " << other;
    }
  }

  std::filesystem::path root_;
};

// Copies of the lanes under test, so many of each, beside each other, told apart by a policy that does nothing: more
// lanes than a subject has.
class ManyLanes {
 public:
  ManyLanes(const LanesUnderTest& of, int copies) {
    rows_.reserve(of.lanes.size() * static_cast<std::size_t>(copies));
    for (std::size_t l = 0; l < of.lanes.size(); ++l) {
      for (int copy = 0; copy < copies; ++copy) {
        rows_.push_back(*of.lanes[l]);
        rows_.back().policy = "copy:" + std::to_string(copy);
        rows_.back().id = id_of(rows_.back().lane_name());
        under_test.lanes.push_back(&rows_.back());
        under_test.on_host.push_back(of.on_host[l]);
      }
    }
  }

  LanesUnderTest under_test;

 private:
  std::vector<Lane> rows_;
};

}  // namespace graze::fuzz
