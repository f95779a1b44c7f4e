// SPDX-License-Identifier: Apache-2.0
// Minimised cases in files. The minimised result (kind=minimised) and the worst pair found on the way to it
// (kind=worst) are inserted before a file's cases, which are not changed.
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
  std::string recorded;          // the originals' common signature; empty for a single original
  std::string from, worst_from;  // the origins of the two pairs: "near_edge_edge:1:42", or empty
  AnyPair original;
};

// Like read_cases. Also checks verdicts: each lane under test that ran in the campaign must give the verdict that the
// pair's signature records. Foreign code is not checked. spec: the campaign's.   Throws: the errors of read_cases.
std::vector<corpus::Entry> checked_cases(const SelectedLanes& under_test, const Json& spec,
                                         const std::filesystem::path& directory, const Json& row);

bool is_minimised(const corpus::Entry& entry);

// All cases with the same recorded signature and the first case's cause get one result: the simplest and the worst of
// their pairs. Cases with another cause are skipped. Cases without a recorded signature get one result for each
// algorithm that is wrong. Minimised entries count as cases only if there are no others. Each result is confirmed.
// Returns: the results; cases on which no lane under test is wrong have none. No results if `stop`, which is called
// before each case, returns true.
// Throws: OracleMismatch, std::runtime_error.
std::vector<MinimisedCase> minimise_cases(
    const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries,
    const std::function<bool()>& stop = [] { return false; });

// The file's text with these results, which replace any results already in it.
// Requires: `entries` are the text's entries.
std::string with_results(const std::string& text, const std::vector<corpus::Entry>& entries,
                         const std::vector<MinimisedCase>& results);

// Minimises the file's cases and writes the results into the file, before the cases.
// Requires: `entries` are the file's entries.   Returns and throws the same as minimise_cases.
std::vector<MinimisedCase> minimise_file(const SelectedLanes& under_test, const std::filesystem::path& file,
                                         const std::vector<corpus::Entry>& entries);

// Whether the file already holds the first case's result for these lanes.
bool has_result(const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries);

}  // namespace graze::fuzz
