// SPDX-License-Identifier: Apache-2.0
// `graze repro --emit`: one of a user's cases as a snippet.
#pragma once

#include <string>
#include <vector>

#include "corpus/pair_format.h"
#include "fuzz/selected_lanes.h"
#include "reports/snippet.h"

namespace graze::cli {

// The first case on which a lane under test is wrong that the snippet can show, and the first such lane, if it
// can be of the algorithm in the case's signature. Where the kind shows no lane: the first case on which any lane is
// wrong, or else the first case. `name` is what the user called the cases. Throws: std::runtime_error when there is
// none, or none with finite coordinates.
std::string emit(reports::SnippetKind kind, const std::string& name, const std::vector<corpus::Entry>& entries,
                 const fuzz::SelectedLanes& under_test);

}  // namespace graze::cli
