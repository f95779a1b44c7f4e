// SPDX-License-Identifier: Apache-2.0
// Checks of the JSON files that reports read: their shapes (shapes.h), and that their counts are within each other and
// add up. A file that a person or another program wrote may hold any.
#pragma once

#include <nlohmann/json.hpp>

namespace graze::reports {

// Throw: std::runtime_error that says what was expected; nlohmann's exceptions for a place that is not there.
void expect_possible_report(const nlohmann::ordered_json& report);
void expect_possible_costs(const nlohmann::ordered_json& costs,
                           const nlohmann::ordered_json& report);  // of that report
void expect_possible_tuned(const nlohmann::ordered_json& tuned);
void expect_possible_pareto(const nlohmann::ordered_json& pareto);

}  // namespace graze::reports
