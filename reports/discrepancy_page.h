// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as one page without scripts: the sentences, then tables and pictures for each pair
// of lanes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// A self-contained HTML page.   json: discrepancy.json.
std::string discrepancy_page(const nlohmann::ordered_json& json);

}  // namespace graze::reports
