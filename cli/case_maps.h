// SPDX-License-Identifier: Apache-2.0
// The ulp maps of a campaign's cases, each stored beside its case as cases/HASH.maps.json for the report.
#pragma once

#include <filesystem>
#include <string>

#include "fuzz/selected_lanes.h"

namespace graze::cli {

// Draws the ulp maps of the file's first case for the subject's lanes under test, along
// analysis::liveliest_coordinates, unless current maps exist and `again` is false.
// Returns: whether this call made the maps.   Throws: OracleMismatch, std::runtime_error.
bool map_case(const fuzz::SelectedLanes& under_test, const std::filesystem::path& case_file, const std::string& subject,
              bool again);

}  // namespace graze::cli
