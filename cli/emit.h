// SPDX-License-Identifier: Apache-2.0
// `graze repro --emit`: prints one of a user's cases as a snippet.
#pragma once

#include <string>
#include <vector>

#include "corpus/pair_format.h"
#include "fuzz/selected_lanes.h"
#include "reports/snippet.h"

namespace graze::cli {

// Emits the first case on which the snippet can show that a lane under test is wrong. If several lanes are wrong on it,
// shows the first one, preferably of the algorithm in the case's signature. If snippets of this kind show no lanes,
// emits the first case on which any lane is wrong, or else the first case. `name` is the user's name for the cases.
// Throws: std::runtime_error if there is no such case, or none with finite coordinates.
std::string emit(reports::SnippetKind kind, const std::string& name, const std::vector<corpus::Entry>& entries,
                 const fuzz::SelectedLanes& under_test);

}  // namespace graze::cli
