// SPDX-License-Identifier: Apache-2.0
// Runs campaigns in their own folders, for tests that compare results.
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
#include "strata/scene/sources.h"

namespace graze::fuzz {

// The files of a campaign that must not depend on how the campaign ran.
inline std::map<std::string, std::string> lasting_files(const std::filesystem::path& directory) {
  std::map<std::string, std::string> files{{"summary.json", read_whole(directory / "summary.json")}};
  for (const auto& file : std::filesystem::directory_iterator(directory / "cases"))
    files[file.path().filename()] = read_whole(file.path());
  return files;
}

// Strata in several kinds of scene, and pairs that no device can draw.
inline std::vector<strata::PairSource> sources_in_scenes(std::uint64_t seed, std::uint64_t pairs) {
  std::vector<strata::PairSource> sources;
  for (const char* text :
       {"extent = [[120000, 120800], [-5400, -5000], [300, 900.5]]\nedges = [0.5, 40]\n"
        "aspect = [1.2, 4, 3000]\ngrid = { decimals = 3 }",
        "extent = [-20, 20]\nedges = [1, 9]\ngrid = { power_of_two = -1 }",
        "extent = [[0, 10], [0, 10], [2.5, 2.5]]\nedges = [0.01, 3]",
        "extent = [-1e-40, 3e-40]\nedges = [1e-41, 1e-40]", "extent = [-8e37, 8e37]\nedges = [1e30, 6e37]"}) {
    for (strata::PairSource& source :
         strata::scene_sources(strata::parse_scene("s", text), "", seed, pairs / 6, {}).sources) {
      source.id += std::to_string(sources.size());
      sources.push_back(std::move(source));
    }
  }
  const auto brought = strata::stratum_sources(seed, pairs / 6, {"sliver"}).front().pair;
  sources.push_back({"brought", pairs / 6, brought});
  return sources;
}

inline Campaign campaign_in(const std::filesystem::path& directory, const SelectedLanes& under_test,
                            std::vector<strata::PairSource> sources, std::uint64_t seed) {
  Campaign c;
  c.seed = seed;
  c.sources = std::move(sources);
  c.under_test = &under_test;
  c.threads = 2;
  c.directory = directory;
  c.spec = campaign_spec(c);
  c.build = build_info(under_test);
  return c;
}

class CampaignFiles : public testing::Test {
 protected:
  CampaignFiles() {
    root_ = std::filesystem::temp_directory_path() / ("graze-campaign-" + std::to_string(getpid()));
    std::filesystem::remove_all(root_);
  }
  ~CampaignFiles() override { std::filesystem::remove_all(root_); }

  Campaign campaign_of(const SelectedLanes& under_test, std::vector<strata::PairSource> sources, std::uint64_t seed,
                       const std::string& name) const {
    return campaign_in(root_ / name, under_test, std::move(sources), seed);
  }

  // Runs at most this many batches of the campaign.   Returns: its summary.
  Json run(const Campaign& c, std::uint64_t stop_after_batches = ~0ull) const {
    std::atomic<bool> stop{false};
    std::uint64_t batches = 0;
    return run_campaign(c, stop, [&](const Progress&) { stop = ++batches >= stop_after_batches; }).summary;
  }

  // Interrupts the campaign after every batch until it is done.   Returns: the number of parts.
  int run_in_parts(const Campaign& c) const {
    int parts = 1;
    while (!run(c, 1)["complete"].get<bool>()) ++parts;
    return parts;
  }

  void expect_same_bytes(const std::string& one, const std::string& other) const {
    const auto files = lasting_files(root_ / one), others = lasting_files(root_ / other);
    EXPECT_EQ(files.size(), others.size()) << one << " and " << other << " keep different cases";
    for (const auto& [name, text] : files) {
      const auto found = others.find(name);
      ASSERT_NE(found, others.end()) << name << " of " << one << " is not in " << other;
      EXPECT_TRUE(text == found->second) << name << " of " << one << " differs in " << other;
    }
  }

  std::filesystem::path root_;
};

// Makes `copies` adjacent copies of each lane under test, so that each subject has unusually many lanes. The policy
// names of the copies have no effect.
class ManyLanes {
 public:
  ManyLanes(const SelectedLanes& of, int copies) {
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

  SelectedLanes under_test;

 private:
  std::vector<Lane> rows_;
};

}  // namespace graze::fuzz
