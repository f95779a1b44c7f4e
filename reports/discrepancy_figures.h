// SPDX-License-Identifier: Apache-2.0
// Pictures of how the values of two lanes differ, as SVG.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// of: an entry of "lanes" in discrepancy.json.
std::string funnel_figure(const nlohmann::ordered_json& of);       // from differing values to differing verdicts
std::string differences_figure(const nlohmann::ordered_json& of);  // in ulps, by side
std::string errors_figure(const nlohmann::ordered_json& of);       // of both lanes, mirrored
std::string band_figure(const nlohmann::ordered_json& of);         // how near to zero signs differ; empty if none does

// Shares of differing pairs by scale and by offset, for the strata that vary these; empty without such strata.
std::string extremes_figures(const nlohmann::ordered_json& of);

}  // namespace graze::reports
