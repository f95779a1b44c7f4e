// SPDX-License-Identifier: Apache-2.0
// Presents how the values of two lanes differ, as tables, discrepancy.json and discrepancy.csv.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/discrepancy_origins.h"
#include "reports/screen.h"

namespace graze::reports {

// The results of `graze discrepancy`: counts for each comparison, and the source lines at which its differences start,
// if they are known.
struct DiscrepancyResults {
  const analysis::DiscrepancySpec& spec;
  analysis::Discrepancies counts;
  std::vector<std::optional<analysis::Origins>> origins;
};

// Returns two tables for each comparison: its questions over all sources, and the source lines whose contraction has
// the largest effect.
std::string discrepancy_tables(const DiscrepancyResults& results, const Screen& screen);

// Returns a table with a row for each comparison: the shares of the pairs on which a value, a sign, a comparison's
// outcome and the verdict differ.
std::string comparisons_table(const DiscrepancyResults& results, const Screen& screen);

// {"lanes": [{"first", "second", "strata": {stratum: counts}}]}; docs/formats.md describes the counts.
nlohmann::ordered_json discrepancy_json(const DiscrepancyResults& results);

// Reads discrepancy.json. Returns null if there is no such file.
// Throws: corpus::FormatError, which names the file, if its counts are impossible.
nlohmann::ordered_json read_discrepancy(const std::filesystem::path& file);

// Lists the counts that differ between two results on the same pairs, for example from two drivers, toolkits or GPUs.
// Also names comparisons that only one result has.   before, after: the contents of discrepancy.json.
std::string discrepancy_changes(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                                const Screen& screen);

// Returns a row for each nonzero count: first,second,stratum,question,value,count,bucket,pairs.
std::string discrepancy_csv(const DiscrepancyResults& results);

}  // namespace graze::reports
