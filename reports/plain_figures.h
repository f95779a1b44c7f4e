// SPDX-License-Identifier: Apache-2.0
// Figures of the plain page as inline SVG that inherits the page's colours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/any_pair.h"

namespace graze::reports {

// Escapes the characters that have a special meaning in HTML.
std::string html(const std::string& text);

// The start of a page without scripts, with the style that such pages share. The page must end with
// "</body>\n</html>\n". title: plain text. style: further CSS rules, each with its newline.
std::string page_head(const std::string& title, const std::string& style);

// The fields "pair" and "drawing" of a card. "pair" has the coordinates as decimals, hex floats and values. "drawing"
// has the contact and the line in which the planes meet.   Requires: finite coordinates.
nlohmann::ordered_json coordinates_of(const AnyPair& pair);
nlohmann::ordered_json drawing_of(const AnyPair& pair);

// Draws a share against the margin for one row of the report's `margins`.   share: "wrong" for wrong verdicts,
// "differs" for verdicts that differ from the cpu lane's.
std::string margin_chart(const nlohmann::ordered_json& row, const char* share);

// Draws the pair of a card in isometric projection: both triangles, the contact, and the line in which the planes meet.
std::string pair_drawing(const nlohmann::ordered_json& card);

}  // namespace graze::reports
