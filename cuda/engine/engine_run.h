// SPDX-License-Identifier: Apache-2.0
// The parts of an engine run that device and host share: limits, the loop over blocks, and the result from the totals.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cuda/engine/engine_block.h"

namespace graze::cuda {

struct EngineLimits {
  std::uint32_t block_pairs = 1u << 22;  // pairs of a block
  std::uint32_t signatures = 1u << 18;   // rows, a power of two. A million pairs of all strata need about 6,000 rows
  std::uint32_t undecided = 1u << 26;    // most pairs left to the host
};

// The number of words in a key that has room for the marks of the largest of these groups.
std::uint32_t key_words(std::span<const LaneGroup> groups);

// Calls judge(b, first, count) for blocks b = 0, 1, … of pairs [first, first + count). After each block, left()
// is called; it returns an upper bound on the number of pairs left to the host so far.
// Returns: the number of pairs judged, which is less than `count` if the next block might leave too many pairs to the
// host.
std::uint64_t run_blocks(const EngineLimits& limits, std::uint64_t first, std::uint64_t count,
                         const std::function<void(int, std::uint64_t, std::uint32_t)>& judge,
                         const std::function<std::uint32_t()>& left);

// The totals over all blocks of a run, in host memory.
struct EngineTotals {
  std::uint32_t left = 0, full = 0;      // pairs left to the host; whether some signature found no free row
  std::vector<std::uint64_t> undecided;  // indices of pairs left to the host, as many as fit
  std::vector<std::uint64_t> rows;       // rows of the SignatureTable
  std::vector<std::uint64_t> counts;     // counts by bucket, counts by extreme, then the disagreements
};

// Throws: std::runtime_error when the signatures or the undecided pairs exceeded their memory.
EngineResult result_of(EngineTotals totals, const SignatureTable& table, std::span<const LaneGroup> groups, Axis axis);

}  // namespace graze::cuda
