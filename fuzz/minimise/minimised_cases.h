// SPDX-License-Identifier: Apache-2.0
// Minimised cases as files: before a file's cases, which stay as they are, stand what they were minimised to
// (kind=minimised) and the worst pair met on the way (kind=worst).
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
  std::string recorded;          // the signature by which the originals go together; empty for an original alone
  std::string from, worst_from;  // the originals that the two pairs came from: "near_edge_edge:1:42", or empty
  Pair original;
};

// As read_cases; and those lanes under test that the campaign ran too, but for foreign code, say of each pair what its
// signature says. spec: the campaign's.   Throws: as read_cases.
std::vector<corpus::Entry> checked_cases(const SelectedLanes& under_test, const Json& spec,
                                         const std::filesystem::path& directory, const Json& row);

// Whether the entry is what a case was minimised to.
bool is_minimised(const corpus::Entry& entry);

// One result for all cases with the same recorded signature, of its algorithm, and the first one's cause: the simplest
// one, and the worst pair of all. Those with another cause stay as they are. Cases without a record have one for each
// algorithm that is wrong. What is minimised already counts as a case only where there is no other. Each result is
// confirmed. Returns: nothing of cases on which no lane of the under_test is wrong; nothing at all once `stop`, which
// is asked before each case, says so.   Throws: OracleMismatch, std::runtime_error.
std::vector<MinimisedCase> minimise_cases(
    const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries,
    const std::function<bool()>& stop = [] { return false; });

// The text of a file with these results in place of those that it may hold already.
// Requires: entries are those of the text.
std::string with_results(const std::string& text, const std::vector<corpus::Entry>& entries,
                         const std::vector<MinimisedCase>& results);

// Whether the file holds the result for its first case on these lanes.
bool has_result(const SelectedLanes& under_test, const std::vector<corpus::Entry>& entries);

}  // namespace graze::fuzz
