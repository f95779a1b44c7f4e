// SPDX-License-Identifier: Apache-2.0
// The ulp maps of a campaign's cases, each stored beside its case as cases/HASH.maps.json for the report.
#pragma once

#include <filesystem>
#include <string>

#include "fuzz/selected_lanes.h"

namespace graze::cli {

// Draws ulp maps of the file's first case, along analysis::liveliest_coordinates, for those lanes under test that
// belong to the subject. Does nothing if current maps exist, unless `again` is true.   Returns: whether this call drew
// maps.   Throws: OracleMismatch, std::runtime_error.
bool map_case(const fuzz::SelectedLanes& under_test, const std::filesystem::path& case_file, const std::string& subject,
              bool again);

}  // namespace graze::cli
