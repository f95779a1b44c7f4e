// SPDX-License-Identifier: Apache-2.0
// Presents errors against costs as a table, sentences, pareto.json and pictures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/pareto.h"
#include "reports/screen.h"

namespace graze::reports {

// Returns a table with a row for each lane, the cheapest first. Dominated lanes are marked.
std::string pareto_table(const analysis::Pareto& pareto, const Screen& screen);

// Describes which lanes are on the front if each call decides one pair (not on a device), what the costs measure, which
// costs are noisy, and which lanes were not timed.
std::vector<std::string> pareto_sentences(const analysis::Pareto& pareto);

// Describes for each lane and extreme up to which exponents the lane is as right as on ordinary pairs.
std::string extremes_text(const analysis::Pareto& pareto, const Screen& screen);

nlohmann::ordered_json pareto_json(const analysis::Pareto& pareto);

// Returns an SVG of 900 x 420 with a point for each lane: its share of pairs without a correct verdict against its
// nanoseconds per pair. Lanes without an error are on the lowest line, "none seen". Dominated lanes are grey.
std::string pareto_figure(const analysis::Pareto& pareto);

// Returns an SVG of 900 x 420: each lane's share of pairs without a correct verdict against the exponent of an extreme.
std::string extreme_figure(const std::vector<analysis::ExtremeCurve>& curves, analysis::Extreme extreme);

}  // namespace graze::reports
