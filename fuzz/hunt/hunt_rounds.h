// SPDX-License-Identifier: Apache-2.0
// The combined results of a hunt's rounds, either of one running process or of merged shards.
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

  // Adds the next round's results, and those of its kinds that no earlier round had.
  void add(const KeptRound& round);

  // hunt.json: {"pairs", "units", "mutations": [{"mutation", "pairs", "disagreements", "units", "kinds"}],
  //  "kinds": [{"key", "index", "mutation"}]}.
  Json told() const;
};

// The only source of a hunt's campaign. It can give only the pairs of cases, which the rounds keep.
strata::PairSource source_of_hunt(std::uint64_t pairs, bool in_doubles, std::shared_ptr<const HuntRounds> rounds);

// The folder of a hunt's rounds.
std::filesystem::path rounds_folder(const std::filesystem::path& hunt);
// The number of pairs per round of a hunt, or of a shard, with this many pairs.
std::uint64_t round_pairs(std::uint64_t pairs);

// The file of the round that begins with the pair `first`.   share: the pairs of the hunt or of its shard.
std::filesystem::path round_file(const std::filesystem::path& hunt, const PairRange& share, std::uint64_t first);
// The only file in that folder if the hunt was merged from shards.
std::filesystem::path merged_rounds_file(const std::filesystem::path& hunt);

// The checksum of the hunt's identity, which is in its round files.
std::uint64_t hunt_checksum(const Json& spec, const Json& build);

// Reads the rounds in the directory, sorted by first pair. Skips files that have a wrong checksum or belong to another
// round.
std::vector<KeptRound> read_rounds(const StoreSpec& hunt);

// Throws: std::runtime_error if a round of the finished hunt is missing or damaged, or if hunt.json does not match the
// rounds.
void expect_rounds_told(const StoreSpec& hunt);

}  // namespace graze::fuzz
