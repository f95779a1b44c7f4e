// SPDX-License-Identifier: Apache-2.0
// Invariants for people: a table, sentences, invariants.json and the simplest cases as files of pairs.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/invariants.h"
#include "reports/screen.h"

namespace graze::reports {

// A row for each lane: the share of pairs, in per cent, on which each invariant is broken.
std::string invariants_table(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants,
                             const Screen& screen);

// What the lanes claim, and on how much the exact decision and the oracle keep all invariants.
std::vector<std::string> invariants_sentences(const analysis::InvariantSpec& spec,
                                              const analysis::Invariants& invariants);

// {"invariants", "truth", "lanes": [{"lane", "invariants": {invariant: {"claimed", "pairs", "changed", "strata",
// "case"}}}]}
nlohmann::ordered_json invariants_json(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants);

// Of each invariant that a lane breaks the name of a file and its text: of each lane the simplest pair on which it does
// and the pair's image, the one on which the lane is wrong first.
std::map<std::string, std::string> invariants_cases(const analysis::InvariantSpec& spec,
                                                    const analysis::Invariants& invariants);

}  // namespace graze::reports
