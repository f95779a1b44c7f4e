// SPDX-License-Identifier: Apache-2.0
// Pictures of ulp maps: PNG with a palette that the colour-blind can tell apart. A cell is a pixel; a cross is around
// the pair itself.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "analysis/ulp_map.h"

namespace graze::reports {

// One panel, kMapSize pixels on each side. The bytes depend on nothing but the panel and the PNG library.
std::string panel_png(const analysis::UlpPanel& panel);

// All panels with their names and counts, at twice that size: the truth and four lanes in the first row, then four
// lanes in each row; below what the coordinates and colours are.
std::string sheet_png(const analysis::UlpMap& map);

// {"title", "x", "y", "size", "legend": [{"colour", "means"}], "panels": [{"name", "shows", "png"}]} as a report's
// page wants it, counts in words, PNGs in base64; and "pair", its 18 coordinates in hex.
nlohmann::ordered_json to_json(const analysis::UlpMap& map);

// Whether that is of this pair.
bool is_map_of(const nlohmann::ordered_json& json, const Pair& pair);

}  // namespace graze::reports
