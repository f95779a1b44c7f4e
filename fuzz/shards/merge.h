// SPDX-License-Identifier: Apache-2.0
// Merges several stores into one campaign: shards, ranks, or results of earlier merges. The result has the same bytes
// as one run without shards, whatever the number, order and executors of the shards. Shards of a hunt are separate
// searches, in any order, so each kind of failure counts once, with its first pair.
#pragma once

#include <filesystem>
#include <vector>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

struct MergeOptions {
  std::vector<std::filesystem::path> parts;  // campaign directories
  std::filesystem::path out;                 // directory of the merged campaign; new or empty
  bool partial = false;  // allows missing parts; the result is an unfinished campaign that can be resumed
};

// Reads every part once. Memory use depends on the sources and signatures, not on the number of parts. A failed merge
// leaves no files.
// Throws: std::runtime_error, in one line, if a part is damaged, belongs to another campaign or build, is not done, is
// missing, or overlaps another. If pairs are missing, the error names the command that judges them.
Outcome merge(const MergeOptions& options);

// Combines the executors of two builds that are otherwise the same, as in "device; twin, verified on …".
// Throws: std::runtime_error that names the second directory if the builds differ in more than their executors.
Json common_build(const Json& one, const Json& other, const std::filesystem::path& directory);

}  // namespace graze::fuzz
