// SPDX-License-Identifier: Apache-2.0
// Figures of the plain page as inline SVG, in the colours of their surroundings.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/pair.h"

namespace graze::reports {

// A text with the characters escaped that HTML gives a meaning to.
std::string html(const std::string& text);

// A card's "pair": its coordinates in decimals, hex floats and values; and its "drawing": where the triangles meet, and
// the line in both planes.   Requires: finite coordinates.
nlohmann::ordered_json coordinates_of(const Pair& pair);
nlohmann::ordered_json drawing_of(const Pair& pair);

// Share wrong against the margin, of one row of the report's `margins`.
std::string margin_chart(const nlohmann::ordered_json& row);

// Both triangles, the contact and the line of both planes, in isometric view, of one of the report's cards.
std::string pair_drawing(const nlohmann::ordered_json& card);

}  // namespace graze::reports
