// SPDX-License-Identifier: Apache-2.0
// Presents how the values of two lanes differ: tables, sentences, discrepancy.json, discrepancy.csv, pictures, and a
// page without scripts.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/discrepancy_origins.h"
#include "reports/screen.h"

namespace graze::reports {

// {"lanes": [{"first", "second", "strata": {stratum: counts}}]}; docs/formats.md describes the counts.
// found, origins: one entry for each comparison. Origins are the source lines where differences start, if known.
nlohmann::ordered_json discrepancy_json(const analysis::DiscrepancySpec& spec, const analysis::Discrepancies& found,
                                        const std::vector<std::optional<analysis::Origins>>& origins);

// Returns two tables for each comparison: its questions in total, and the source lines whose contraction has
// the largest effect.   json, here and below: the result of discrepancy_json.
std::string discrepancy_tables(const nlohmann::ordered_json& json, const Screen& screen);

// Returns a table with a row for each comparison: the shares of pairs on which a value, a sign, a comparison's outcome
// and the verdict differ.
std::string comparisons_table(const nlohmann::ordered_json& json, const Screen& screen);

// Returns a row for each nonzero count: first,second,stratum,question,value,count,bucket,pairs.
std::string discrepancy_csv(const nlohmann::ordered_json& json);

// Reads discrepancy.json. Returns null if there is no such file.
// Throws: corpus::FormatError, which names the file, if its counts are impossible.
nlohmann::ordered_json read_discrepancy(const std::filesystem::path& file);

// Lists the counts that differ between two results on the same pairs, for example from two drivers, toolkits or GPUs.
// Also lists comparisons that only one result has.   before, after: the contents of discrepancy.json.
std::string discrepancy_changes(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                                const Screen& screen);

// Returns five sentences: how often values and verdicts differ, where differences start, which lane is closer to the
// exact values, how close to zero the values with different signs are, and the remedy. If one of these is unknown, its
// sentence says so. Then follows a sentence for each comparison that has only verdicts.
// json: the contents of discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

// SVG pictures of how the values of two lanes differ.   of: an entry of "lanes" in discrepancy.json.
std::string funnel_figure(const nlohmann::ordered_json& of);       // from differing values to differing verdicts
std::string differences_figure(const nlohmann::ordered_json& of);  // how large differences are, by direction
std::string errors_figure(const nlohmann::ordered_json& of);       // errors of both lanes, mirrored
std::string band_figure(const nlohmann::ordered_json& of);  // values with different signs, by size; empty if none

// Pictures of the shares of differing pairs by scale or offset, one for each stratum that varies it. May be empty.
std::string extremes_figures(const nlohmann::ordered_json& of);

// Returns a self-contained HTML page: the sentences, then tables and pictures for each pair of lanes.
std::string discrepancy_page(const nlohmann::ordered_json& json);

// Returns a table with a row for each compared value: both lanes' values, their distance in ulps, the exact value, both
// errors, and a mark if the comparison's outcome differs.   Requires: as for analysis::runs_beside.
std::string side_by_side(const analysis::LanesCompared& lanes, const AnyPair& pair, const Screen& screen);

}  // namespace graze::reports
