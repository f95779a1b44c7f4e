// SPDX-License-Identifier: Apache-2.0
// The picture of a campaign: how often each f32/cpu lane is wrong, against how close the call was.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// An SVG of 900 x 420: share of wrong verdicts over all strata, one line for each lane, by margin bucket; readable on
// light and dark ground. Requires: what summary.json holds.
std::string margin_figure(const nlohmann::ordered_json& summary);

}  // namespace graze::reports
