// SPDX-License-Identifier: Apache-2.0
// Finds failures in a campaign's directory or in single cases, and adds them to the regression corpus.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "fuzz/campaign/campaign.h"
#include "fuzz/regression/regression.h"

namespace graze::fuzz {

struct FoundFailure {
  std::string signature;
  corpus::Entry entry;
  std::uint64_t count;    // how many pairs have this signature
  std::string seen;       // the build and the campaign: "commit, compiler, toolkit, device; campaign HASH"
  std::string file = "";  // the file with the entry; empty for the file that the user named
};

// Returns the first case of each signature that matches one of the shell patterns, or of all signatures if there are no
// patterns. The minimised case comes first if there is one. Takes at most `most` signatures of each
// subject: the most frequent ones.
// Throws: UsageError if the directory holds no finished campaign; FormatError.
std::vector<FoundFailure> found_in_campaign(const std::filesystem::path& directory,
                                            const std::vector<std::string>& globs, std::size_t most);

// Returns one failure for each signature of the entries. An entry's signature is its field `signature`; without that
// field it has one signature for each algorithm that is wrong. If there are minimised entries, only they are used.
std::vector<FoundFailure> found_in_cases(const std::vector<corpus::Entry>& entries, const Json& build,
                                         std::span<const Lane* const> lanes, const DecideLanes& decide);

enum class Added { as_new, seen_again, known, not_run };

// Replays a failure and adds it as a case. If its signature already has a case, the failure is counted there instead.
// A fixed case that fails again becomes failing, with the new pair. A failure that is added twice in a row counts once,
// so that an interrupted command can be repeated. If none of the wrong lanes runs here, nothing is added.
// Throws: std::runtime_error if the pair does not have the signature.
Added add(RegressionCorpus& corpus, const FoundFailure& failure, std::span<const Lane* const> lanes,
          const DecideLanes& decide);

}  // namespace graze::fuzz
