// SPDX-License-Identifier: Apache-2.0
// Presents invariants: a table, sentences, invariants.json, and the simplest cases as files of pairs.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/invariants.h"
#include "reports/screen.h"

namespace graze::reports {

// Returns a row for each lane: the percentage of pairs on which each invariant is broken.
std::string invariants_table(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants,
                             const Screen& screen);

// Says what the lanes claim, and on how many pairs the exact decision and the oracle keep all invariants.
std::vector<std::string> invariants_sentences(const analysis::InvariantSpec& spec,
                                              const analysis::Invariants& invariants);

// {"invariants", "truth", "lanes": [{"lane", "invariants": {invariant: {"claimed", "pairs", "changed", "strata",
// "case"}}}]}
nlohmann::ordered_json invariants_json(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants);

// For each invariant that a lane breaks, a file name and its text. For each lane, the file has the simplest pair on
// which the lane breaks the invariant, and the pair's image. The one on which the lane is wrong comes first.
std::map<std::string, std::string> invariants_cases(const analysis::InvariantSpec& spec,
                                                    const analysis::Invariants& invariants);

}  // namespace graze::reports
