// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/rank_stores.h"

#include <algorithm>

#include "core/cannot.h"
#include "core/text.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/own_files.h"

namespace graze::fuzz {

namespace fs = std::filesystem;

fs::path rank_directory(const fs::path& campaign, int rank) { return campaign / ("rank-" + std::to_string(rank)); }

std::vector<fs::path> rank_directories(const fs::path& campaign) {
  std::vector<fs::path> found;
  if (!fs::is_directory(campaign)) return found;
  for (const auto& entry : fs::directory_iterator(campaign)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("rank-") && parse_whole(name.substr(5)) && !entry.is_symlink() && entry.is_directory() &&
        may_fill(entry.path(), {kDatabase}))
      found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

void take_in_ranks(const Campaign& campaign, Store& store) {
  for (const fs::path& directory : rank_directories(campaign.directory)) {
    if (fs::exists(directory / kDatabase)) {
      StoreSpec of_rank = store_spec(campaign);
      of_rank.directory = directory;
      std::uint64_t pairs = 0;
      try {
        const StoreSpec found = recorded_store(directory);
        if (found.spec != of_rank.spec || found.build != of_rank.build)
          throw std::runtime_error(cannot("use", directory, "it holds a rank of another campaign; remove it"));
        if (!found.shard.whole())
          throw std::runtime_error(cannot("use", directory,
                                          "it holds shard " + found.shard.name() +
                                              " of the campaign, not a rank; move it away, and merge shards with "
                                              "`graze merge`"));
        for_each_row(of_rank, [&](const PairRange& range, const StoredCounts& counts) {
          if (!store.holds(range)) store.commit(range, counts);  // a killed run may have committed it already
          pairs += range.pairs;
        });
      } catch (const DamagedStore& error) {
        const std::string what = error.what();
        throw std::runtime_error(what.substr(0, what.rfind("; ")) + "; remove " + directory.string() +
                                 " to judge its pairs again");
      }
      append_timing(campaign.directory, {{"pairs", pairs}, {"seconds", 0}, {"machine", machine_name()}});
    }
    remove_store(directory);
  }
}

}  // namespace graze::fuzz
