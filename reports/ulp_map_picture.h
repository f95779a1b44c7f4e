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

// All panels with their names and counts, at twice that size. The first row has the truth and four lanes, the other
// rows have four lanes each. Coordinates and colours are explained below.
std::string sheet_png(const analysis::UlpMap& map);

// {"title", "x", "y", "size", "legend": [{"colour", "means"}], "panels": [{"name", "shows", "png"}], "pair"} for a
// report's page: counts in words, PNGs in base64, and the pair's 18 coordinates in hex, and "f64" if it has doubles.
nlohmann::ordered_json to_json(const analysis::UlpMap& map);

// Whether the JSON can be a map of this pair with panels of the truth and of some of these lanes, each at most once:
// its fields are of the right kinds, and no panel counts more cells than it has. The pictures are not read.
bool is_map_of(const nlohmann::ordered_json& json, const AnyPair& pair, const std::vector<std::string>& lanes);

}  // namespace graze::reports
