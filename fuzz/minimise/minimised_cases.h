// SPDX-License-Identifier: Apache-2.0
// Minimised cases as files. Before a file's cases, which stay unchanged, come their minimised result (kind=minimised)
// and the worst pair met on the way (kind=worst).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "corpus/pair_format.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/minimise/minimise.h"

namespace graze::fuzz {

struct MinimisedCase {
  Failure failure;
  Minimised result;
  std::string recorded;          // the signature that the originals share; empty for a single original
  std::string from, worst_from;  // the origins of the two pairs: "near_edge_edge:1:42", or empty
  AnyPair original;
};

// As read_cases. Also checks that the lanes under test that ran in the campaign, except foreign code, have the verdicts
// that each pair's signature records. spec: the campaign's.   Throws: as read_cases.
std::vector<corpus::Entry> checked_cases(const SelectedLanes& under_test, const Json& spec,
                                         const std::filesystem::path& directory, const Json& row);

// Whether the entry is a minimised result.
bool is_minimised(const corpus::Entry& entry);

// Makes one result for all cases that share a recorded signature, its algorithm, and the first case's cause: the
// simplest pair and the worst pair of all. Cases with another cause stay unchanged. Cases without a recorded signature
// get one result for each algorithm that is wrong. Minimised entries count as cases only if there are no others. Each
// result is confirmed.
// Returns: nothing for cases on which no lane under test is wrong; nothing at all once `stop`, called before each case,
// returns true.
// Throws: OracleMismatch, std::runtime_error.
std::vector<MinimisedCase> minimise_cases(
    const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries,
    const std::function<bool()>& stop = [] { return false; });

// The text of a file with these results instead of those that it may already hold.
// Requires: `entries` are those of the text.
std::string with_results(const std::string& text, const std::vector<corpus::Entry>& entries,
                         const std::vector<MinimisedCase>& results);

// Minimises the cases of that file and writes the results into it, before the cases.
// Requires: `entries` are those of the file.   Returns, throws: as minimise_cases.
std::vector<MinimisedCase> minimise_file(const SelectedLanes& under_test, const std::filesystem::path& file,
                                         const std::vector<corpus::Entry>& entries);

// Whether the file holds the result for its first case on these lanes.
bool has_result(const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries);

}  // namespace graze::fuzz
