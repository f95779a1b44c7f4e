// SPDX-License-Identifier: Apache-2.0
// Pictures of ulp maps as PNG, with a palette suitable for the colour-blind. A cell is a pixel; a cross surrounds the
// pair itself.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/ulp_map.h"

namespace graze::reports {

// One panel, kMapSize pixels on each side. The bytes depend only on the panel and the PNG library.
std::string panel_png(const analysis::UlpPanel& panel);

// All panels with their names and counts, at twice that size. The first row has the truth and four lanes, and the other
// rows have four lanes each. The coordinates and colours are explained below them.
std::string sheet_png(const analysis::UlpMap& map);

// {"title", "x", "y", "size", "legend": [{"colour", "means"}], "panels": [{"name", "shows", "png"}], "pair"} for a
// report's page: counts in words, PNGs in base64, the pair's 18 coordinates in hex, and "f64" if it has doubles.
nlohmann::ordered_json to_json(const analysis::UlpMap& map);

// Whether the JSON can be a map of this pair, with panels of the truth and of some of these lanes, each at most once.
// Checks that its fields have the right kinds, and that no panel counts more cells than it has; does not read pictures.
bool is_map_of(const nlohmann::ordered_json& json, const AnyPair& pair, const std::vector<std::string>& lanes);

}  // namespace graze::reports
