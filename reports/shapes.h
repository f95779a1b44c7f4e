// SPDX-License-Identifier: Apache-2.0
// The shapes of the JSON files that reports read. A file that a person or another program wrote may be of any shape.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graze::reports {

// Checks that each field is there, and of its type; shapes.cpp has a table of them. Fields that it does not name are
// free. shape: "report", "costs", "tuned" or "pareto".
// Throws: std::runtime_error: "expected a count at /lanes/0/errors/declined, found -1".
void expect_shape(const nlohmann::ordered_json& value, const std::string& shape);

}  // namespace graze::reports
