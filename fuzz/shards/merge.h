// SPDX-License-Identifier: Apache-2.0
// One campaign of several stores: shards, ranks, or campaigns that were merged before. The result is that of one run of
// the whole, the same bytes, whatever the parts, their order, and who ran them. Shards of a hunt are searches of their
// own: of their kinds of failure each counts once, by the first pair; the result does not depend on their order either.
#pragma once

#include <filesystem>
#include <vector>

#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/sums.h"

namespace graze::fuzz {

struct MergeOptions {
  std::vector<std::filesystem::path> parts;  // directories
  std::filesystem::path out;                 // that of the campaign; new, or empty
  bool partial = false;                      // takes what is there: an unfinished campaign, which a run goes on with
};

// Reads every part once; its memory is that of the sources and signatures, not of the parts. Nothing stays behind where
// it fails.
// Throws: std::runtime_error, in one line, for a part that is damaged, of another campaign or build, not done, missing
// or overlaps another; with the command that fills a gap.
Outcome merge(const MergeOptions& options);

// What ran the lanes of both, where they differ in nothing else: "device; twin, verified on …".
// Throws: std::runtime_error, naming the directory of the second, for another build.
Json common_build(const Json& one, const Json& other, const std::filesystem::path& directory);

// Writes a campaign that is complete from the sums of all its pairs: its store, summary and cases.
// Requires: no gaps; a directory without a store.
Outcome write_merged(const Campaign& campaign, const Sums& sums);

}  // namespace graze::fuzz
