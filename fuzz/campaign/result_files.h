// SPDX-License-Identifier: Apache-2.0
// A campaign's result files other than its database: summary.json, cases/ and timings.json.
#pragma once

#include <utility>
#include <vector>

#include "corpus/pair_format.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/files.h"
#include "oracle/truth.h"

namespace graze::fuzz {

// The truth as fields of a case: truth, contact, margin, margin_ulps.
std::vector<std::pair<std::string, std::string>> truth_fields(const oracle::Truth& truth);

// Whether the lane's differences from a cpu lane are counted: if the lane is not itself a cpu lane, and `lanes` holds
// the cpu lane of the same algorithm, scalar and policy.
bool is_compared_with_cpu(const std::string& lane, const std::vector<std::string>& lanes);

// Writes summary.json and cases/ from the store. If the cases in a file have not changed, the file keeps the
// minimiser's results.
// Returns: the summary.
Json write_summary(const Campaign& campaign, const Store& store, bool complete);

// The summary from each source's counts and the signatures of all sources.
Json summary_of(const StoreSpec& spec, const std::vector<StoredCounts>& of_source,
                const std::map<std::string, SignatureCount>& signatures,
                const std::map<std::string, SignatureCount>& executor_mismatches, bool complete);

// Like write_summary, but the campaign may be a part of another. Compacts the store of a complete part.
// pairs: how many pairs are done.
// Returns: for a part {"shard", "complete", "pairs", "disagreements", "signatures"}.
Json write_own_summary(const Campaign& campaign, Store& store, bool complete, std::uint64_t pairs);

// The file of a signature's cases, from its row in the summary.
// Throws: std::runtime_error if the path is not within cases/, because the file may be written.
std::filesystem::path case_file(const std::filesystem::path& directory, const Json& row);

// Reads a signature's cases, preceded by the minimiser's results, from the file named in its row of the summary. Checks
// that the file's name, second line and cases belong to the signature, and that no case is missing. Also checks that
// all cases have different origins in the campaign's strata, and that the recorded truth of each pair is right.
// spec: the campaign's.   Throws: FormatError, in one line, with the command that writes the file again.
std::vector<corpus::Entry> read_cases(const std::filesystem::path& directory, const Json& spec, const Json& row);

// Whether the stratum draws this pair from the recorded seed and index. Also true where this cannot be checked: for
// scenes, meshes and hunts, and for a case without the field `stratum`.
bool is_drawn(const corpus::Entry& entry);

// Whether the file's text is `fresh`, the text that a campaign would write, with or without the minimiser's results.
bool is_minimised_from(const std::string& text, const std::string& fresh);

// The error for a case file that fails a check.   found: the defect, such as "it is missing or empty".
corpus::FormatError wrong_cases(const std::filesystem::path& directory, const Json& row, const std::string& found);

// Whether results may be written to the folder (see may_fill). The folder must be empty, or hold a campaign or shard of
// `graze fuzz`, `hunt` or `merge`.
bool may_hold_campaign(const std::filesystem::path& folder);

// Returns the runs in timings.json, each an object; none without this file.   Throws: FormatError if the file is
// damaged.
Json read_timings(const std::filesystem::path& directory);

// Called before a run, so that damaged records cannot make it fail at its end: timings.json must be readable, and a
// damaged status.json is removed.
// Throws: the errors of read_timings and remove_damaged_status.
void expect_usable_records(const std::filesystem::path& directory);

// Adds a run to timings.json, the only file that depends on when, where and with which engine the campaign ran.
void append_timing(const std::filesystem::path& directory, const Json& run, const Json& oracle = {});

}  // namespace graze::fuzz
