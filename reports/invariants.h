// SPDX-License-Identifier: Apache-2.0
// Presents the results of `graze invariants` as a table, sentences, invariants.json, and files of the simplest cases.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/invariants.h"
#include "reports/screen.h"

namespace graze::reports {

// Returns a table with a row for each lane: the percentage of pairs on which the lane breaks each invariant.
std::string invariants_table(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants,
                             const Screen& screen);

// Describes which invariants the lanes claim, and on how many pairs the exact decision and the oracle keep all of them.
std::vector<std::string> invariants_sentences(const analysis::InvariantSpec& spec,
                                              const analysis::Invariants& invariants);

// {"invariants", "truth", "lanes": [{"lane", "invariants": {invariant: {"claimed", "pairs", "changed", "strata",
// "case"}}}]}
nlohmann::ordered_json invariants_json(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants);

// Returns the texts of files by name: one file for each invariant that some lane breaks. For each such lane, the file
// has the simplest pair on which the lane breaks the invariant, and its image; the wrongly decided pair is first.
std::map<std::string, std::string> invariants_cases(const analysis::InvariantSpec& spec,
                                                    const analysis::Invariants& invariants);

}  // namespace graze::reports
