// SPDX-License-Identifier: Apache-2.0
// How users name cases: a file of pairs, a stratum's pair as STRATUM:SEED:INDEX, or a pair drawn in a scene as
// STRATUM@SCENE:SEED:INDEX.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "corpus/pair_format.h"
#include "fuzz/selected_lanes.h"
#include "oracle/truth.h"
#include "strata/mesh_readers/soup.h"

namespace graze::cli {

// Returns: at least one case. If a pair was drawn from a stratum, its entry has the fields stratum, seed and index.
// Throws: UsageError for an invalid name, FormatError for a file that is missing or not in the format,
// std::runtime_error for a file without a case; what expect_exact_input throws if the input must be exact.
std::vector<corpus::Entry> read_cases(const std::string& name, bool exact_input = false);

// Like read_cases, but also prints each case's written_note.
std::vector<corpus::Entry> read_noted_cases(const std::string& name, bool exact_input);

// Returns what identifies the case to a reader: STRATUM:SEED:INDEX, the case that it was minimised from, its name, or
// its line in the file.
std::string shown_name(const std::string& file, const corpus::Entry& entry);

// The truth of the pair in its own coordinate type.
oracle::Truth truth_of(const corpus::Entry& entry);

// "as written: disjoint, 1e-11 apart; as stored in float32: they share an area (it rounds number 12, 1.00000000001)",
// if rounding to double or to float32 changes the truth; otherwise empty. truth: the entry's truth.
std::string written_note(const corpus::Entry& entry, const oracle::Truth& truth);

// The verdicts that the entry's campaign stored for lanes of foreign code that cannot run now. Empty unless the entry's
// signature is one of that code.
std::vector<std::pair<std::string, Verdict>> stored_verdicts_of(const corpus::Entry& entry,
                                                                const std::vector<fuzz::LaneLeftOut>& left_out,
                                                                Verdict truth);

// The same verdicts as a line: "stored by the campaign: mine/f32/cpu disjoint !". Empty if there are none.
std::string stored_verdicts(const corpus::Entry& entry, const std::vector<fuzz::LaneLeftOut>& left_out, Verdict truth);

// Adds --exact-input to a verb that reads pairs or meshes.
CLI::Option* add_exact_input(CLI::App& command, bool& exact_input);

// Throws: UsageError that names the entry's first number that is not exact in float32.
void expect_exact_input(const std::string& name, const corpus::Entry& entry);

// Prints the notes about meshes on standard error, each once.
// Throws: UsageError if the input must be exact and float32 rounded a coordinate.
void say_notes(const std::vector<std::string>& notes, const strata::Rounding& rounding, bool exact_input);

}  // namespace graze::cli
