// SPDX-License-Identifier: Apache-2.0
// The runs of two lanes on one pair as text, value beside value.
#pragma once

#include <string>

#include "analysis/discrepancy.h"
#include "reports/screen.h"

namespace graze::reports {

// A row for each value that a comparison sees: both lanes' values, how many ulps they are apart, the exact value, both
// errors, and where a comparison goes the other way.   Requires: a finite pair.
std::string side_by_side(const analysis::LanesCompared& lanes, const Pair& pair, const Screen& screen);

}  // namespace graze::reports
