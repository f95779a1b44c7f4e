// SPDX-License-Identifier: Apache-2.0
// The combined results of a hunt's rounds, from one running process or from merged shards.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "fuzz/campaign/store_file.h"
#include "fuzz/hunt/round_bytes.h"

namespace graze::fuzz {

struct HuntRounds {
  KeptRound all;  // all rounds combined into one; kinds in the order in which they were found
  std::set<std::string> coarse, kinds;

  // Adds the next round's results, without the kinds that an earlier round already had.
  void add(const KeptRound& round);

  // hunt.json: {"pairs", "units", "mutations": [{"mutation", "pairs", "disagreements", "units", "kinds"}],
  //  "kinds": [{"key", "index", "mutation"}]}.
  Json told() const;
};

// The only source of a hunt's campaign. This source has only the kept cases' pairs, which are in the rounds.
strata::PairSource source_of_hunt(std::uint64_t pairs, bool in_doubles, std::shared_ptr<const HuntRounds> rounds);

std::filesystem::path rounds_folder(const std::filesystem::path& hunt);
// The number of pairs per round, for a hunt or shard with this many pairs.
std::uint64_t round_pairs(std::uint64_t pairs);

// The file of the round that begins with the pair `first`.   share: the pairs of the hunt or the shard.
std::filesystem::path round_file(const std::filesystem::path& hunt, const PairRange& share, std::uint64_t first);
// The only file in rounds_folder if the hunt was merged from shards.
std::filesystem::path merged_rounds_file(const std::filesystem::path& hunt);

// The checksum of the hunt's identity. Round files record it.
std::uint64_t hunt_checksum(const Json& spec, const Json& build);

// Reads the rounds in the directory, sorted by first pair. Skips files that have a wrong checksum or belong to another
// round.
std::vector<KeptRound> read_rounds(const StoreSpec& hunt);

// Throws: std::runtime_error if a round of the finished hunt is missing or damaged, or if hunt.json does not match the
// rounds.
void expect_rounds_told(const StoreSpec& hunt);

}  // namespace graze::fuzz
