// SPDX-License-Identifier: Apache-2.0
// A campaign's picture: how often each f32/cpu lane is wrong, against the size of the margin.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Returns an SVG of 900 x 420: the share of wrong verdicts over all strata by margin bucket, with a line for each lane.
// It is readable on light and dark backgrounds.
// Requires: the contents of summary.json.
std::string margin_figure(const nlohmann::ordered_json& summary);

}  // namespace graze::reports
