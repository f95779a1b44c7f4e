// SPDX-License-Identifier: Apache-2.0
// The league (fuzz/league/league.h) as JSON, as a table on a terminal, and as a page with drawings.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/league/league.h"
#include "reports/screen.h"

namespace graze::reports {

// A subject's own words, for those of the league that are foreign.
struct LeagueSubject {
  std::string name, what;  // as in --subject NAME=WHAT
  std::string version, source, convention;
};

// So many drawings stand beside a page: libraries' clear failures first, then those on general pairs.
inline constexpr std::size_t kMostDrawings = 40;

// {"seed", "pairs", "strata", "groups": {group: pairs}, "subjects": [...], "rows": [...], "failures": [...],
//  "failures_not_repeated", "timings"}: rows with the fewest clearly wrong verdicts first, then the fewest wrong ones.
//  All
// but the timings depends on the pairs and the code alone.
// Requires: nanoseconds of each row of the league.
nlohmann::ordered_json league_json(const fuzz::League& league, const std::vector<LeagueSubject>& subjects,
                                   const std::vector<std::optional<double>>& nanoseconds, const std::string& machine,
                                   const std::string& date);

// The drawings that failures of the JSON name: file and SVG.
std::map<std::string, std::string> league_drawings(const nlohmann::ordered_json& league);

std::string league_table(const nlohmann::ordered_json& league, const Screen& screen = {});

// Markdown. command: that made it.
std::string league_page(const nlohmann::ordered_json& league, const std::string& command);

}  // namespace graze::reports
