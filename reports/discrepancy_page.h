// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as five sentences, as pictures, and as one page without scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// What share of values and of verdicts differs, where differences start, which lane is nearer to the exact values, how
// near to zero signs differ, and the remedy. Also names open questions. Then a sentence for each comparison of verdicts
// only. json: discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

// SVG pictures of how the values of two lanes differ.   of: an entry of "lanes" in discrepancy.json.
std::string funnel_figure(const nlohmann::ordered_json& of);       // from differing values to differing verdicts
std::string differences_figure(const nlohmann::ordered_json& of);  // in ulps, by side
std::string errors_figure(const nlohmann::ordered_json& of);       // of both lanes, mirrored
std::string band_figure(const nlohmann::ordered_json& of);         // how near to zero signs differ; empty if none does

// Shares of differing pairs by scale and by offset, for the strata that vary these; empty without such strata.
std::string extremes_figures(const nlohmann::ordered_json& of);

// A self-contained HTML page: the sentences, then tables and pictures for each pair of lanes.   json: discrepancy.json.
std::string discrepancy_page(const nlohmann::ordered_json& json);

}  // namespace graze::reports
