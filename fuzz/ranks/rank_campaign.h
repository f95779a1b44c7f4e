// SPDX-License-Identifier: Apache-2.0
// A campaign by the ranks that mpirun started: each takes blocks from the shared counter into a store of its own, in
// DIR/rank-R; at the end a tree of reductions leaves the sums with the root, whose campaign is that of one process.
// Of a rank that died, what it had committed stays: the next run takes it in, and judges what is missing.
#pragma once

#include <optional>

#include "fuzz/campaign/campaign.h"
#include "fuzz/ranks/ranks.h"

namespace graze::fuzz {

// Runs or goes on with the campaign.
// Returns: the outcome on the root once all is done; nothing on the other ranks, and where a rank was stopped.
// Throws: as run_campaign, on the rank that fails, which must then abort.
std::optional<Outcome> run_on_ranks(Campaign& campaign, Ranks& ranks, const std::atomic<bool>& stop);

// Pairs in a block, of so many that are left.
std::uint64_t block_pairs(std::uint64_t left, int ranks, std::uint64_t most);

// The blocks of these ranges, by number, in an order that soon visits all sources.
class Blocks {
 public:
  Blocks(std::vector<PairRange> ranges, std::uint64_t pairs);
  std::uint64_t count() const { return until_.empty() ? 0 : until_.back(); }
  // Requires: number < count().
  PairRange at(std::uint64_t number) const;

 private:
  std::vector<PairRange> ranges_;
  std::uint64_t pairs_, stride_ = 1;
  std::vector<std::uint64_t> until_;  // blocks up to the end of each range
};

}  // namespace graze::fuzz
