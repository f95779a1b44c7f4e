// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

struct CsvTable {
  std::string name, text;  // "rates.csv"; a header row, then rows as in RFC 4180
};

// Returns the tables rates, margins (by stratum, from the campaign's directory), thresholds, extremes and signatures,
// and compare if the report has it.   Requires: a report of this campaign.
std::vector<CsvTable> csv_tables(const std::filesystem::path& directory, const nlohmann::ordered_json& report);

}  // namespace graze::reports
