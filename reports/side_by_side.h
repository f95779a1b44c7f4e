// SPDX-License-Identifier: Apache-2.0
// Shows the runs of two lanes on one pair as text, with their values side by side.
#pragma once

#include <string>

#include "analysis/discrepancy.h"
#include "reports/screen.h"

namespace graze::reports {

// Returns a table with a row for each compared value: both lanes' values, their distance in ulps, the exact value, both
// errors, and a mark if the comparison's outcome differs.   Requires: as for analysis::runs_beside.
std::string side_by_side(const analysis::LanesCompared& lanes, const AnyPair& pair, const Screen& screen);

}  // namespace graze::reports
