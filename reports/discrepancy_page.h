// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as five sentences, as pictures, and as one page without scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// Returns five sentences: on which shares of the pairs values and verdicts differ, where differences start, which lane
// is nearer to the exact values, how near to zero signs differ, and the remedy. If one of these is not known, its
// sentence says so. A sentence for each comparison of verdicts alone follows.   json: the contents of discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

// SVG pictures of how the values of two lanes differ.   of: an entry of "lanes" in discrepancy.json.
std::string funnel_figure(const nlohmann::ordered_json& of);       // from differing values to differing verdicts
std::string differences_figure(const nlohmann::ordered_json& of);  // how large differences are, by direction
std::string errors_figure(const nlohmann::ordered_json& of);       // errors of both lanes, mirrored
std::string band_figure(const nlohmann::ordered_json& of);  // how near to zero signs differ; empty if no sign does

// Pictures of the shares of differing pairs by scale or by offset, one for each stratum that varies it. May be empty.
std::string extremes_figures(const nlohmann::ordered_json& of);

// Returns a self-contained HTML page: the sentences, then tables and pictures for each pair of lanes.
std::string discrepancy_page(const nlohmann::ordered_json& json);

}  // namespace graze::reports
