// SPDX-License-Identifier: Apache-2.0
// What a user names a case by: a file of pairs, or a stratum's pair as STRATUM:SEED:INDEX,
// or STRATUM@SCENE:SEED:INDEX of a scene.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "corpus/pair_format.h"
#include "oracle/truth.h"

namespace graze::cli {

// Returns: the cases, at least one; a stratum's pair has its three numbers as fields.
// Throws: UsageError for a name that is none, FormatError for a file that is not in the format or missing,
// std::runtime_error for one without a case.
std::vector<corpus::Entry> read_cases(const std::string& name);

// "as written: disjoint, 1e-11 apart; as stored in float32: they share an area", where float32 makes that difference
// to the entry's numbers; else empty.
std::string written_note(const corpus::Entry& entry, const oracle::Truth& stored);

// --exact-input, of the verbs that read pairs.
CLI::Option* add_exact_input(CLI::App& command, bool& exact_input);

// Throws: UsageError that names the entry's first number that float32 does not hold.
void expect_exact_input(const std::string& name, const corpus::Entry& entry);

}  // namespace graze::cli
