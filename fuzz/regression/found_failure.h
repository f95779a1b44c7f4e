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
  std::uint64_t count;    // pairs of this signature
  std::string seen;       // by which build, and in what: "commit, compiler, toolkit, device; campaign HASH"
  std::string kind = "";  // its kind's key; empty where it is not known
  std::string file = "";  // that holds the entry; empty where it is the one that was named
};

// Of each kind of failure the simplest case, where its signature or its kind's key matches
// one of the shell patterns (or there is none); of each subject only the `most` commonest kinds.
// Throws: UsageError for a directory that holds no finished campaign; FormatError.
std::vector<FoundFailure> found_in_campaign(const std::filesystem::path& directory,
                                            const std::vector<std::string>& globs, std::size_t most);

// One failure for each signature of the entries: that of the field `signature`, or those of all algorithms that are
// wrong. Minimised entries stand for all.
std::vector<FoundFailure> found_in_cases(const std::vector<corpus::Entry>& entries, const Json& build,
                                         std::span<const Lane* const> lanes, const DecideLanes& decide);

enum class Added { as_new, seen_again, known };

// A failure becomes a case, after a replay, unless its signature or its kind has one: then it counts there. A case that
// was fixed and is wrong again is failing again, with the new pair. The same failure twice in a row counts once, so
// that an interrupted command can be run again. Throws: std::runtime_error when the pair is not one of the signature.
Added add(RegressionCorpus& corpus, const FoundFailure& failure, std::span<const Lane* const> lanes,
          const DecideLanes& decide);

}  // namespace graze::fuzz
