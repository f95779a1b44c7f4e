// SPDX-License-Identifier: Apache-2.0
// Writes a campaign's results as CSV.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

struct CsvTable {
  std::string name, text;  // name: "rates.csv"; text: a header row, then rows as in RFC 4180
};

// Returns the tables rates, margins, differs, thresholds, extremes and signatures, and the table compare if the report
// has a comparison. Margins by stratum come from the campaign's directory.   Requires: a report of this campaign.
std::vector<CsvTable> csv_tables(const std::filesystem::path& directory, const nlohmann::ordered_json& report);

}  // namespace graze::reports
