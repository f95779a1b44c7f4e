// SPDX-License-Identifier: Apache-2.0
// Presents the league (fuzz/league/league.h) as JSON, as a table on a terminal, and as a page with drawings.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/league/league.h"
#include "reports/screen.h"

namespace graze::reports {

// Facts that a foreign subject of the league states about itself.
struct LeagueSubject {
  std::string name, what;  // as in --subject NAME=WHAT
  std::string version, source, convention;
};

// The limit on drawings that accompany a page. Libraries' failures are drawn first, the clear ones before the others.
inline constexpr std::size_t kMostDrawings = 40;

// {"seed", "pairs", "strata", "groups": {group: pairs}, "subjects": [...], "rows": [...], "failures": [...],
//  "failures_not_repeated", "timings"}
// Rows are sorted by the number of clearly wrong verdicts, then by the share of wrong verdicts, lowest first.
// Everything except the timings depends only on the pairs and the code.
// nanoseconds: per pair, one entry for each row of the league.
nlohmann::ordered_json league_json(const fuzz::League& league, const std::vector<LeagueSubject>& subjects,
                                   const std::vector<std::optional<double>>& nanoseconds, const std::string& machine,
                                   const std::string& date);

// Returns the drawings that the JSON's failures name, as SVG by file name.
std::map<std::string, std::string> league_drawings(const nlohmann::ordered_json& league);

std::string league_table(const nlohmann::ordered_json& league, const Screen& screen = {});

// Returns a page in Markdown.   command: the command that made the league.
std::string league_page(const nlohmann::ordered_json& league, const std::string& command);

}  // namespace graze::reports
