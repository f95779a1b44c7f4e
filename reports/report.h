// SPDX-License-Identifier: Apache-2.0
// The report of a campaign: everything that the page shows, as reports/web/src/report.ts describes it, from what the
// campaign and the minimiser stored. No lane runs here. The same campaign gives the same bytes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Throws: as fuzz::checked_summary, FormatError too for other damaged files.
nlohmann::ordered_json make_report(const std::filesystem::path& directory);

// What the campaign's lanes cost, and the answer with it (costs.h): apart from the report, because it depends on the
// machine. null where the campaign has no timings of its lanes.   Throws: as make_report.
nlohmann::ordered_json make_costs(const std::filesystem::path& directory);

// {"tuned", "pareto"}: the tune.json and pareto.json in the directory, null where they are not.
// Throws: FormatError for one of another shape, or with counts that cannot be.
nlohmann::ordered_json make_choices(const std::filesystem::path& directory);

// The command that runs the whole campaign again.   Requires: what summary.json holds.
std::string campaign_command(const nlohmann::ordered_json& summary);

// The report as text: each row on a line of its own, so that two can be compared.
std::string report_text(const nlohmann::ordered_json& report);

// A report that was written before.   Throws: FormatError, also for counts that cannot be.
nlohmann::ordered_json read_report(const std::filesystem::path& file);

// The costs.json of that report; null where there is none.   Throws: as read_report.
nlohmann::ordered_json stored_costs(const std::filesystem::path& file, const nlohmann::ordered_json& report);

}  // namespace graze::reports
