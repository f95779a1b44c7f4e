// SPDX-License-Identifier: Apache-2.0
// Draws ulp maps as PNG, with colours that colour-blind people can tell apart. Each cell is a pixel. A cross surrounds
// the pair itself.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/ulp_map.h"

namespace graze::reports {

// One panel, kMapSize pixels on each side. The bytes depend only on the panel and the PNG library.
std::string panel_png(const analysis::UlpPanel& panel);

// Draws all panels with their names and counts, at twice the size of panel_png. The first row has the truth and four
// lanes, and each further row has four lanes. The legend below explains the coordinates and colours.
std::string sheet_png(const analysis::UlpMap& map);

// {"title", "x", "y", "size", "legend": [{"colour", "means"}], "panels": [{"name", "shows", "png"}], "pair"} for a
// report's page: counts in words, PNGs in base64, the pair's 18 coordinates as hex floats, and "f64" if it has doubles.
nlohmann::ordered_json to_json(const analysis::UlpMap& map);

// Whether the JSON can be a map of this pair, with panels of the truth and of some of these lanes, each at most once.
// Checks that the fields have the right types and that no panel counts more cells than it has. Ignores the pictures.
bool is_map_of(const nlohmann::ordered_json& json, const AnyPair& pair, const std::vector<std::string>& lanes);

}  // namespace graze::reports
