// SPDX-License-Identifier: Apache-2.0
// For tests: artificial summaries, and a small campaign with its kinds of failure.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/campaign/campaign.h"
#include "fuzz/counts_json.h"
#include "fuzz/files.h"
#include "fuzz/minimise/kinds.h"

namespace graze::reports {

using fuzz::Json;
namespace fs = std::filesystem;

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A summary of these lanes, with the same counts in each stratum.
inline Json summary_of(const std::vector<std::string>& lanes, const std::vector<std::string>& strata,
                       const analysis::LaneCounts& counts) {
  Json summary = {
      {"spec", {{"seed", 1}, {"pairs", 1000 * strata.size()}, {"strata", strata}, {"lanes", lanes}}},
      {"build", {{"version", "0"}, {"commit", "c"}, {"compiler", "g"}, {"cuda", nullptr}, {"device", nullptr}}},
      {"complete", true},
      {"strata", Json::object()},
      {"disagreements", 0},
      {"signatures", Json::array()}};
  for (const std::string& stratum : strata) {
    Json& row = summary["strata"][stratum] = {
        {"pairs", 1000}, {"intersects", 400}, {"lanes", Json::object()}, {"margins", Json::object()}};
    for (const std::string& lane : lanes) {
      row["lanes"][lane] = fuzz::counts_json(counts);
      row["lanes"][lane]["differs_from_cpu"] = lane.ends_with("/cpu") ? 0 : counts.differs_from_cpu;
    }
  }
  return summary;
}

// Runs small campaigns in a temporary directory: `one` for all tests, and others for single tests.
class CampaignTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("graze_report_" + std::to_string(getpid()));
    run("one", 1);
    store_kinds("one");
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static inline const std::vector<std::string> kLanes = {"moller_1997/*", "interval_overlap/*", "exact/f32/cpu"};

  static fuzz::SelectedLanes lanes(const std::vector<std::string>& patterns = kLanes) {
    return fuzz::select_lanes(patterns, fuzz::Executor::twin);
  }

  static void run(const std::string& name, int threads, std::uint64_t seed = 3,
                  const std::vector<std::string>& patterns = kLanes) {
    const fuzz::SelectedLanes under_test = lanes(patterns);
    fuzz::Campaign c;
    c.seed = seed;
    c.sources = strata::stratum_sources(c.seed, 15'000, {"near_edge_edge", "extreme_scale", "thesis"});
    c.under_test = &under_test;
    c.threads = threads;
    c.directory = root_ / name;
    c.spec = fuzz::campaign_spec(c);
    c.build = fuzz::build_info(under_test);
    fuzz::run_campaign(c, std::atomic<bool>(false), [](const fuzz::Progress&) {});
  }

  static Json summary(const std::string& name) { return Json::parse(fuzz::read_whole(root_ / name / "summary.json")); }

  // Stores kinds as `graze minimize` does, but for pairs that are not minimised.
  static void store_kinds(const std::string& name, const std::vector<std::string>& patterns = kLanes) {
    const fuzz::SelectedLanes under_test = lanes(patterns);
    fuzz::write_kinds(root_ / name, under_test, fuzz::find_kinds(under_test, root_ / name, summary(name)));
  }

  static inline fs::path root_;
};

}  // namespace graze::reports
