// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "fuzz/campaign/store_file.h"

namespace graze::cli {

// Counts the verdicts that changed between two complete campaigns on the same pairs, as rows for
// reports::add_comparison. If both versions of a --subject's code still exist, runs them on the pairs and counts
// exactly.   Returns: null if a database is missing.   Throws: what fuzz::changed_verdicts throws.
fuzz::Json changed_rows(const std::string& before, const std::string& after);

// Prints the "compare" part of a report: the headline, each change with its smallest cases, and how the campaigns
// differ.
void print_comparison(const fuzz::Json& compare);

}  // namespace graze::cli
