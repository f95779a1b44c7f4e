// SPDX-License-Identifier: Apache-2.0
// Merges several stores into one campaign: shards, ranks, or campaigns that were merged before. The result has the same
// bytes as one run without shards, whatever the shards, their order and their executors. Shards of a hunt are separate
// searches: each kind of failure counts once, with its first pair. The order of a hunt's parts does not matter either.
#pragma once

#include <filesystem>
#include <vector>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

struct MergeOptions {
  std::vector<std::filesystem::path> parts;  // campaign directories
  std::filesystem::path out;                 // directory of the merged campaign; new or empty
  bool partial = false;  // accepts missing parts; the result is an unfinished campaign that a run can resume
};

// Reads every part once. The memory it needs depends on the sources and signatures, not on the number of parts. Leaves
// no files if it fails.
// Throws: std::runtime_error, in one line, if a part is damaged, belongs to another campaign or build, is not done, is
// missing, or overlaps another. For missing pairs the error names the command that judges them.
Outcome merge(const MergeOptions& options);

// Combines the executors of two builds that are otherwise equal: "device; twin, verified on …".
// Throws: std::runtime_error that names the second directory if the builds differ otherwise.
Json common_build(const Json& one, const Json& other, const std::filesystem::path& directory);

}  // namespace graze::fuzz
