// SPDX-License-Identifier: Apache-2.0
// Laws for people: a table, sentences, laws.json and the simplest cases as files of pairs.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/laws.h"
#include "reports/screen.h"

namespace graze::reports {

// A row for each lane: the share of pairs, in per cent, on which each law is broken.
std::string laws_table(const analysis::LawSpec& spec, const analysis::Laws& laws, const Screen& screen);

// What the lanes claim, and on how much the exact decision and the oracle keep all laws.
std::vector<std::string> laws_sentences(const analysis::LawSpec& spec, const analysis::Laws& laws);

// {"laws", "truth", "lanes": [{"lane", "laws": {law: {"claimed", "pairs", "changed", "strata", "case"}}}]}
nlohmann::ordered_json laws_json(const analysis::LawSpec& spec, const analysis::Laws& laws);

// Of each law that a lane breaks the name of a file and its text: of each lane the simplest pair on which it does and
// the pair's image, the one on which the lane is wrong first.
std::map<std::string, std::string> laws_cases(const analysis::LawSpec& spec, const analysis::Laws& laws);

}  // namespace graze::reports
