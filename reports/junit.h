// SPDX-License-Identifier: Apache-2.0
// Results as JUnit XML, which continuous integration shows as tests.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "fuzz/selected_lanes.h"

namespace graze::reports {

struct JunitCase {
  std::string suite, name;  // a lane and a stratum; a file of cases and a case
  std::string failure;      // its first line is the message; empty for a test that passes
  std::string skipped;      // why the test did not run; empty if it did
};

// Neighbours of the same suite form one. Characters that XML forbids are written as \xHH.
std::string junit(std::span<const JunitCase> cases);

// One test for each lane and stratum that has pairs, and one that is skipped for each lane that was asked for and did
// not run. A test fails if the lane is wrong on a pair; then the message has the simplest pair that the campaign kept
// of that stratum, or of all if it kept none there.   Throws: as fuzz::read_cases.
std::vector<JunitCase> junit_of_campaign(const std::filesystem::path& directory, const nlohmann::ordered_json& summary,
                                         std::span<const fuzz::LaneLeftOut> left_out);

}  // namespace graze::reports
