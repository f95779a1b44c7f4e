// SPDX-License-Identifier: Apache-2.0
// Presents how the values of two lanes differ, as sentences, tables, discrepancy.json and discrepancy.csv.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/discrepancy_origins.h"
#include "reports/screen.h"

namespace graze::reports {

// The findings of `graze discrepancy`: counts, and where the differences of each comparison start, if that is known.
struct DiscrepancyResults {
  const analysis::DiscrepancySpec& spec;
  analysis::Discrepancies counts;
  std::vector<std::optional<analysis::Origins>> origins;
};

// For each comparison, a table of its questions over all sources, and one of the source lines that differ most.
std::string discrepancy_tables(const DiscrepancyResults& results, const Screen& screen);

// A row for each comparison: on which share of the pairs a value, a sign, a comparison and the verdict differ.
std::string comparisons_table(const DiscrepancyResults& results, const Screen& screen);

// {"lanes": [{"first", "second", "strata": {stratum: counts}}]}; docs/formats.md describes the counts.
nlohmann::ordered_json discrepancy_json(const DiscrepancyResults& results);

// Reads discrepancy.json; null if there is none.   Throws: corpus::FormatError, which names the file, if its counts are
// impossible.
nlohmann::ordered_json read_discrepancy(const std::filesystem::path& file);

// Lists the counts that differ between two discrepancy.json of the same pairs, such as from two drivers, toolkits or
// GPUs. Names lanes and strata that only one of them has.
std::string discrepancy_changes(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                                const Screen& screen);

// A row for each count that is not zero: first,second,stratum,question,value,count,bucket,pairs.
std::string discrepancy_csv(const DiscrepancyResults& results);

}  // namespace graze::reports
