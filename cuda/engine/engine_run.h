// SPDX-License-Identifier: Apache-2.0
// What a run of an engine needs whoever computes it: its limits, its way through the blocks, and its result from the
// memory that the blocks added to.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cuda/engine/engine_block.h"

namespace graze::cuda {

struct EngineLimits {
  std::uint32_t block_pairs = 1u << 22;  // decided together
  std::uint32_t signatures = 1u << 18;   // a power of two; a million pairs of all strata make six thousand
  std::uint32_t undecided = 1u << 26;    // pairs left to the host
};

// Words of a key that holds the marks of any of these groups.
std::uint32_t key_words(std::span<const LaneGroup> groups);

// Calls judge(b, first, count) for blocks b = 0, 1, … of pairs [first, first + count), and after each left(), how many
// pairs may have been left to the host so far.
// Returns: the pairs judged: all, or fewer when those left to the host might soon be more than the limit.
std::uint64_t run_blocks(const EngineLimits& limits, std::uint64_t first, std::uint64_t count,
                         const std::function<void(int, std::uint64_t, std::uint32_t)>& judge,
                         const std::function<std::uint32_t()>& left);

// What all blocks of a run added to, in the host's memory.
struct EngineTotals {
  std::uint32_t left = 0, full = 0;      // pairs left to the host; whether signatures found no row
  std::vector<std::uint64_t> undecided;  // the first of their indices, as many as there is memory for
  std::vector<std::uint64_t> rows;       // of the SignatureTable
  std::vector<std::uint64_t> counts;     // by bucket, by extreme, and the disagreements
};

// Throws: std::runtime_error when there was no memory for all signatures or undecided pairs.
EngineResult result_of(EngineTotals totals, const SignatureTable& table, std::span<const LaneGroup> groups, Axis axis);

}  // namespace graze::cuda
