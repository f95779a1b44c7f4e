// SPDX-License-Identifier: Apache-2.0
// Presents how often only the verdicts of two lanes differ, as a part of what `graze discrepancy` finds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/verdicts_apart.h"
#include "reports/screen.h"

namespace graze::reports {

// {"first", "second", "total": {"pairs", "differs", "of_first": counts, "of_second": counts},
//  "strata": {stratum: the same and the "simplest" {"place", "pair"} that differs}}
nlohmann::ordered_json verdicts_json(const analysis::TwoDeciders& deciders,
                                     const std::vector<strata::PairSource>& sources,
                                     const std::vector<analysis::VerdictsApart>& found);

// of: such an object. How often the verdicts differ and which lane is wrong then, and why no value is compared.
std::string verdicts_sentence(const nlohmann::ordered_json& of);

// A row for each stratum.
std::string verdicts_table(const nlohmann::ordered_json& of, const Screen& screen);
std::string verdicts_section(const nlohmann::ordered_json& of);  // of the page
std::string verdicts_csv(const nlohmann::ordered_json& of);      // rows as in discrepancy.csv

// Throws: std::runtime_error for counts that cannot be.
void expect_possible_verdicts(const nlohmann::ordered_json& of);

}  // namespace graze::reports
