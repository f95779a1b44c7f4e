// SPDX-License-Identifier: Apache-2.0
// Makes the report of a campaign from the files of the campaign and the minimiser. The report has all data of the page,
// as reports/web/src/report.ts describes it. No lane runs here. The same campaign always gives the same bytes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// Throws: as fuzz::checked_summary does, and FormatError for other damaged files.
nlohmann::ordered_json make_report(const std::filesystem::path& directory);

// Returns the costs of the campaign's lanes, and the answer that includes them (costs.h). The report has no costs,
// because they depend on the machine. Null if the campaign has no lane timings.   Throws: as make_report does.
nlohmann::ordered_json make_costs(const std::filesystem::path& directory);

// Returns {"tuned", "pareto", "discrepancy"}: the contents of tune.json and pareto.json, and the sentences of
// discrepancy.json. Each is null if its file is missing from the directory.
// Throws: FormatError for a file of another shape or with impossible counts.
nlohmann::ordered_json make_choices(const std::filesystem::path& directory);

// The report as text with each row on its own line, so that two reports can be compared.
std::string report_text(const nlohmann::ordered_json& report);

// Reads a stored report.   Throws: FormatError, also for impossible counts.
nlohmann::ordered_json read_report(const std::filesystem::path& file);

// Reads the report's costs.json. Returns null if there is no such file.   Throws: as read_report does.
nlohmann::ordered_json stored_costs(const std::filesystem::path& file, const nlohmann::ordered_json& report);

struct CsvTable {
  std::string name, text;  // name: "rates.csv"; text: a header row, then rows as in RFC 4180
};

// Returns the tables rates, margins, differs, thresholds, extremes and signatures, and the table compare if the report
// has a comparison. Margins by stratum come from the campaign's directory.   Requires: a report of this campaign.
std::vector<CsvTable> csv_tables(const std::filesystem::path& directory, const nlohmann::ordered_json& report);

// Returns the campaign's picture, an SVG of 900 x 420: the share of wrong verdicts over all strata by margin bucket,
// with a line for each f32/cpu lane. It is readable on light and dark backgrounds.
// Requires: the contents of summary.json.
std::string margin_figure(const nlohmann::ordered_json& summary);

}  // namespace graze::reports
