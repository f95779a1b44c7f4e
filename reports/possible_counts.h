// SPDX-License-Identifier: Apache-2.0
// Checks the JSON files that reports read: their shapes (shapes.h), and that counts are within their limits and add up,
// because files written by people or other programs may be inconsistent.
#pragma once

#include <nlohmann/json.hpp>

namespace graze::reports {

// Throw: std::runtime_error, which names the expectation; nlohmann's exceptions for a missing field.
void expect_possible_report(const nlohmann::ordered_json& report);
void expect_possible_costs(const nlohmann::ordered_json& costs,
                           const nlohmann::ordered_json& report);  // costs of that report
void expect_possible_tuned(const nlohmann::ordered_json& tuned);
void expect_possible_pareto(const nlohmann::ordered_json& pareto);
void expect_possible_discrepancy(const nlohmann::ordered_json& discrepancy);

}  // namespace graze::reports
