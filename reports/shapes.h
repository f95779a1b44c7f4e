// SPDX-License-Identifier: Apache-2.0
// The shapes of the JSON files that reports read. Files written by people or other programs may have any shape.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Checks that each field exists and has its type, by a table in shapes.cpp. Fields that the table does not name are
// allowed. shape: "report", "costs", "tuned" or "pareto".
// Throws: std::runtime_error: "expected a count at /lanes/0/errors/declined, found -1".
void expect_shape(const nlohmann::ordered_json& value, const std::string& shape);

}  // namespace graze::reports
