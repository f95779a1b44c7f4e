// SPDX-License-Identifier: Apache-2.0
// Failures on their way into the regression corpus, from a campaign's directory or from single cases.
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
  std::uint64_t count;  // pairs of this signature
  std::string seen;     // by which build, and in what: "commit, compiler, toolkit, device; campaign HASH"
};

// The first entry of each file of cases, where the campaign's signature matches one of the shell patterns (or there is
// none). A minimised entry has a signature of its own: those that became one are one failure, counted together.
// Of each algorithm only the `most` commonest.
// Throws: UsageError for a directory that holds no finished campaign; FormatError.
std::vector<FoundFailure> found_in_campaign(const std::filesystem::path& directory,
                                            const std::vector<std::string>& globs, std::size_t most);

// One failure for each signature of the entries: that of the field `signature`, or those of all algorithms that are
// wrong. Minimised entries stand for all.
std::vector<FoundFailure> found_in_cases(const std::vector<corpus::Entry>& entries, const Json& build,
                                         std::span<const Lane* const> lanes, const DecideLanes& decide);

enum class Added { as_new, seen_again, known };

// A signature's first failure becomes a case, after a replay; further ones count. A case that was fixed and is wrong
// again is failing again, with the new pair. The same failure twice in a row counts once, so that an interrupted
// command can be run again.
// Throws: std::runtime_error when the pair is not one of the signature.
Added add(RegressionCorpus& corpus, const FoundFailure& failure, std::span<const Lane* const> lanes,
          const DecideLanes& decide);

}  // namespace graze::fuzz
