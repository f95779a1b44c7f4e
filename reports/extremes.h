// SPDX-License-Identifier: Apache-2.0
// Finds up to which extremes a lane is as right as on ordinary pairs, for a campaign's counts and for `graze pareto`.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "analysis/extremes.h"

namespace graze::reports {

// Defines "as right" for readers of the sentences.
inline constexpr const char* kAsRightMeans =
    "As right: errs on at most twice as large a share of the pairs, or on at most 0.1 %, with 95 % confidence.";

// "as right as at 1 (errs on 16.1 %) from 2^-40 to 2^44; errs more at 2^-44 and 2^44". A point stands for the
// exponents [exponent, exponent + step), or for one exponent if the step is 0.   Requires: rising exponents.
std::string right_words(std::span<const analysis::ErrorsAt> points, int step);

// Adds to a row of a report's extremes the fields that are computed from its cells. "origin" is the exponent of the
// cell with which the others are compared. "says" is the text of right_words. Each cell with errors gets "times": the
// ratio of its share to the origin's, with a lower and an upper bound. A value is null if the origin has no errors.
void add_right_range(nlohmann::ordered_json& row);

}  // namespace graze::reports
