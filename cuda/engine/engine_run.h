// SPDX-License-Identifier: Apache-2.0
// The parts of an engine run that do not depend on where it is computed: its limits, the loop over blocks, and its
// result from the accumulated totals.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cuda/engine/engine_block.h"

namespace graze::cuda {

struct EngineLimits {
  std::uint32_t block_pairs = 1u << 22;  // pairs decided together
  std::uint32_t signatures = 1u << 18;   // rows; a power of two. A million pairs of all strata need about 6,000
  std::uint32_t undecided = 1u << 26;    // pairs left to the host
};

// The number of words in a key that has room for the marks of any of these groups.
std::uint32_t key_words(std::span<const LaneGroup> groups);

// Calls judge(b, first, count) for blocks b = 0, 1, … of pairs [first, first + count). After each block it calls
// left(), which returns how many pairs may have been left to the host so far.
// Returns: the number of pairs judged, less than `count` when the pairs left to the host might soon exceed the limit.
std::uint64_t run_blocks(const EngineLimits& limits, std::uint64_t first, std::uint64_t count,
                         const std::function<void(int, std::uint64_t, std::uint32_t)>& judge,
                         const std::function<std::uint32_t()>& left);

// The totals that all blocks of a run have added to, in host memory.
struct EngineTotals {
  std::uint32_t left = 0, full = 0;      // pairs left to the host; whether a signature found no free row
  std::vector<std::uint64_t> undecided;  // the first of their indices, as many as fit
  std::vector<std::uint64_t> rows;       // rows of the SignatureTable
  std::vector<std::uint64_t> counts;     // counts by bucket, counts by extreme, then the disagreements
};

// Throws: std::runtime_error when the signatures or the undecided pairs exceeded their memory.
EngineResult result_of(EngineTotals totals, const SignatureTable& table, std::span<const LaneGroup> groups, Axis axis);

}  // namespace graze::cuda
