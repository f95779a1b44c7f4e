// SPDX-License-Identifier: Apache-2.0
// Checks the JSON files that reports read: that they have the right shape, and that counts are within limits and add
// up. Files written by people or other programs may be inconsistent.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Checks that each field in the table of shapes.cpp exists and has its type. Other fields are allowed. shape: "report",
// "costs", "tuned" or "pareto".
// Throws: std::runtime_error: "expected a count at /lanes/0/errors/declined, found -1".
void expect_shape(const nlohmann::ordered_json& value, const std::string& shape);

// All of these throw std::runtime_error, which names what was expected, or nlohmann's exceptions for a missing field.
void expect_possible_report(const nlohmann::ordered_json& report);
void expect_possible_costs(const nlohmann::ordered_json& costs,
                           const nlohmann::ordered_json& report);  // costs of that report
void expect_possible_tuned(const nlohmann::ordered_json& tuned);
void expect_possible_pareto(const nlohmann::ordered_json& pareto);
void expect_possible_discrepancy(const nlohmann::ordered_json& discrepancy);

}  // namespace graze::reports
