// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "fuzz/campaign/store_file.h"

namespace graze::cli {

// Which verdicts changed between two complete campaigns on the same pairs: the rows that reports::add_comparison takes.
// Counts them on the pairs themselves where the code of both is there: that of --subject, as the campaigns recorded it.
// Returns: null if a database is missing.   Throws: as fuzz::changed_verdicts.
fuzz::Json changed_rows(const std::string& before, const std::string& after);

// Prints "compare" of a report: the headline, what changed with its smallest cases, and how the campaigns differ.
void print_comparison(const fuzz::Json& compare);

}  // namespace graze::cli
