// SPDX-License-Identifier: Apache-2.0
// What a report tells of a case that takes lanes to find out: every lane's verdict, and why lanes are wrong. The
// minimiser stores it beside the case file, as cases/HASH.json.
#pragma once

#include <filesystem>

#include "corpus/pair_format.h"
#include "fuzz/campaign/store.h"
#include "fuzz/lanes_under_test.h"

namespace graze::fuzz {

// The case of a file that a report shows: what it was minimised to, or else the first.
// Requires: at least one entry.
const corpus::Entry& shown_case(const std::vector<corpus::Entry>& entries);

// The 18 hex floats, as a file of pairs has them.
std::string pair_text(const Pair& pair);

std::filesystem::path facts_file(const std::filesystem::path& case_file);

// {"pair", "verdicts": {lane: verdict}, "sentences": [of the algorithm in the case's signature]}.
// Throws: std::runtime_error where a device and its twin differ.
Json case_facts(const LanesUnderTest& under_test, const corpus::Entry& entry);

// Writes the case's facts, unless they are there for the same pair and lanes.
void store_facts(const LanesUnderTest& under_test, const std::filesystem::path& case_file);

}  // namespace graze::fuzz
