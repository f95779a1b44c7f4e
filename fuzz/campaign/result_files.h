// SPDX-License-Identifier: Apache-2.0
// The files that a campaign leaves beside its database: summary.json, cases/, and timings.json.
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

// Writes summary.json and cases/ from what the store holds; a case file that has not changed keeps what the minimiser
// put into it.   Returns: the summary.
Json write_summary(const Campaign& campaign, const Store& store, bool complete);

// The summary of a store's counts, those of each source and the signatures of all.
Json summary_of(const StoreSpec& spec, const std::vector<StoredCounts>& of_source,
                const std::map<std::string, SignatureCount>& signatures,
                const std::map<std::string, SignatureCount>& executor_mismatches, bool complete);

// What a shard says instead, until all are merged: {"shard", "complete", "pairs", "disagreements", "signatures"}.
Json shard_summary(const Shard& shard, const Store& store, bool complete, std::uint64_t pairs);

// The file of a signature's cases, by its row in the summary.
// Throws: std::runtime_error where that is not within cases/: what reads a summary also writes these files.
std::filesystem::path case_file(const std::filesystem::path& directory, const Json& row);

// A signature's cases, by its row in the summary, and the minimiser's results before them. Checked: the file's name,
// its head and its cases are those of the signature, no case is missing, and each pair has the truth that stands beside
// it. Throws: FormatError, in one line, with the command that writes the file again.
std::vector<corpus::Entry> read_cases(const std::filesystem::path& directory, const Json& row);

// Whether the file is `fresh` as a campaign writes it, but for results of the minimiser.
bool is_minimised_from(const std::string& text, const std::string& fresh);

// The error of a file of cases that does not check.   found: "another pair".
corpus::FormatError wrong_cases(const std::filesystem::path& directory, const Json& row, const std::string& found);

// Whether results may go into the folder, see may_fill: nothing is there, or what `graze fuzz`, `hunt` and `merge`
// leave of a campaign or a shard.
bool may_hold_campaign(const std::filesystem::path& folder);

// The runs in timings.json, each an object; none where there is no such file.
// Throws: FormatError for a damaged one.
Json read_timings(const std::filesystem::path& directory);

// Before work in a campaign's folder, so that its records do not end the work: timings.json can be read, and
// status.json too; a damaged one is removed.   Throws: as read_timings and remove_damaged_status.
void expect_usable_records(const std::filesystem::path& directory);

// Adds a run to timings.json, the only file that depends on when, where and by which engine the campaign ran.
void append_timing(const std::filesystem::path& directory, const Json& run, const Json& oracle = {});

}  // namespace graze::fuzz
