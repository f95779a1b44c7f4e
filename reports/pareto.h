// SPDX-License-Identifier: Apache-2.0
// Errors against costs for people: a table, sentences, pareto.json and pictures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/pareto.h"
#include "reports/screen.h"

namespace graze::reports {

// A row for each lane, the cheapest first; those that another one beats say so.
std::string pareto_table(const analysis::Pareto& pareto, const Screen& screen);

// How far each lane stays right, in a sentence for each extreme.
std::vector<std::string> extreme_sentences(const std::vector<analysis::ExtremeCurve>& curves);

nlohmann::ordered_json pareto_json(const analysis::Pareto& pareto);

// An SVG of 900 x 420: each lane a point, share of wrong verdicts against nanoseconds a pair; lanes without an error
// stand on a line of their own, with the bound that the number of pairs allows. Dominated lanes are grey.
std::string pareto_figure(const analysis::Pareto& pareto);

// An SVG of 900 x 420: share of wrong verdicts of each lane against the exponent of one extreme.
std::string extreme_figure(const std::vector<analysis::ExtremeCurve>& curves, analysis::Extreme extreme);

}  // namespace graze::reports
