// SPDX-License-Identifier: Apache-2.0
// Runs a campaign on the ranks that mpirun started. Each rank takes block numbers from the shared counter and writes to
// its own store, DIR/rank-R. At the end a tree of reductions brings the sums to the root. The result equals that of a
// single process. If a rank dies, its committed pairs remain: the next run adds them and judges the missing pairs.
#pragma once

#include <optional>

#include "fuzz/campaign/campaign.h"
#include "fuzz/ranks/ranks.h"

namespace graze::fuzz {

// Returns: on the root, the outcome when all work is done; nothing on other ranks, or if any rank was stopped. Throws:
// the errors of run_campaign, on the rank that fails, which must then abort.
std::optional<Outcome> run_on_ranks(Campaign& campaign, Ranks& ranks, const std::atomic<bool>& stop);

// The number of pairs per block if `left` pairs remain.
std::uint64_t block_pairs(std::uint64_t left, int ranks, std::uint64_t most);

// Splits ranges into numbered blocks, in an order that reaches all sources early.
class Blocks {
 public:
  Blocks(std::vector<PairRange> ranges, std::uint64_t pairs);
  std::uint64_t count() const { return until_.empty() ? 0 : until_.back(); }
  // Requires: number < count().
  PairRange at(std::uint64_t number) const;

 private:
  std::vector<PairRange> ranges_;
  std::uint64_t pairs_, stride_ = 1;
  std::vector<std::uint64_t> until_;  // the number of blocks up to the end of each range
};

}  // namespace graze::fuzz
