// SPDX-License-Identifier: Apache-2.0
// Presents, for `graze discrepancy`, how often the verdicts of two lanes of a user's code differ.
// For a CUDA source, also presents how the operands of its comparisons differ.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/operands_apart.h"
#include "analysis/verdicts_apart.h"
#include "reports/screen.h"

namespace graze::reports {

// "core/vec3.h:48"; empty if the line is not known.
std::string line_of(const cuda::SourceLine& line);

// {"first", "second", "total": {"pairs", "differs", "of_first": counts, "of_second": counts},
//  "strata": {stratum: the same, and "simplest": {"place", "pair"}, the simplest pair with different verdicts}}
// operands: null if they were not observed. Otherwise the result also has "operands": {"pairs", "verdict", "lines":
// [{"line", "within", "compared", …}]}, or "why_no_operands".
nlohmann::ordered_json verdicts_json(const analysis::TwoDeciders& deciders,
                                     const std::vector<strata::PairSource>& sources,
                                     const std::vector<analysis::VerdictsApart>& found,
                                     const analysis::OperandsApart* operands);

// Describes how often the verdicts differ, which lane is wrong, and which comparison decides, or why no value is
// compared.
// of, here and below: the result of verdicts_json.
std::string verdicts_sentence(const nlohmann::ordered_json& of);

// Returns a table with a row for each stratum, and one with a row for each source line whose operands differ.
std::string verdicts_table(const nlohmann::ordered_json& of, const Screen& screen);
std::string verdicts_section(const nlohmann::ordered_json& of);  // a section of the page
std::string verdicts_csv(const nlohmann::ordered_json& of);      // rows as in discrepancy.csv

// Throws: std::runtime_error for impossible counts.
void expect_possible_verdicts(const nlohmann::ordered_json& of);

}  // namespace graze::reports
