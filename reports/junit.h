// SPDX-License-Identifier: Apache-2.0
// Writes results as JUnit XML, which continuous-integration services show as tests.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "fuzz/selected_lanes.h"

namespace graze::reports {

struct JunitCase {
  std::string suite, name;  // a lane and a stratum, or a case file and a case
  std::string failure;      // its first line is the message; empty for a test that passes
  std::string skipped;      // why the test did not run; empty if it did
};

// Consecutive cases with the same suite form one suite. Characters that XML forbids are written as \xHH.
std::string junit(std::span<const JunitCase> cases);

// Returns a test for each lane and each stratum that has pairs, and a skipped test for each requested lane that did not
// run. A test fails if the lane is wrong on a pair. Its message then has the simplest pair that the campaign kept for
// that stratum, or for any stratum if it kept none there.   Throws: as fuzz::read_cases does.
std::vector<JunitCase> junit_of_campaign(const std::filesystem::path& directory, const nlohmann::ordered_json& summary,
                                         std::span<const fuzz::LaneLeftOut> left_out);

}  // namespace graze::reports
