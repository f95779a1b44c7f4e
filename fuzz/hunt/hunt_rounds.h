// SPDX-License-Identifier: Apache-2.0
// What the rounds of a hunt kept, put together: of one process as it goes, or of shards when they are merged.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "fuzz/campaign/store_file.h"
#include "fuzz/hunt/round_bytes.h"

namespace graze::fuzz {

struct HuntRounds {
  KeptRound all;  // what they kept, as one round of all their pairs; kinds in the order in which they were found
  std::set<std::string> coarse, kinds;

  // Adds what the next round kept; of its kinds those that are new.
  void add(const KeptRound& round);

  // hunt.json: {"pairs", "units", "mutations": [{"mutation", "pairs", "disagreements", "units", "kinds"}],
  //  "kinds": [{"key", "index", "mutation"}]}.
  Json told() const;
};

// The folder of a hunt's rounds.
std::filesystem::path rounds_folder(const std::filesystem::path& hunt);
// The one file there of a hunt that was merged of shards.
std::filesystem::path merged_rounds_file(const std::filesystem::path& hunt);

// The checksum of what a hunt is of, which its files of rounds carry.
std::uint64_t hunt_checksum(const Json& spec, const Json& build);

// Those of the directory, by their first pairs; what does not check is left out.
std::vector<KeptRound> read_rounds(const StoreSpec& hunt);

}  // namespace graze::fuzz
