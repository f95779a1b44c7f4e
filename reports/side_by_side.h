// SPDX-License-Identifier: Apache-2.0
// The runs of two lanes on one pair as text, value beside value.
#pragma once

#include <string>

#include "analysis/discrepancy.h"
#include "reports/screen.h"

namespace graze::reports {

// A row for each value that a comparison sees: both lanes' values, their distance in ulps, the exact value, both
// errors, and a mark if the comparison's outcome differs.   Requires: as for analysis::runs_beside.
std::string side_by_side(const analysis::LanesCompared& lanes, const AnyPair& pair, const Screen& screen);

}  // namespace graze::reports
