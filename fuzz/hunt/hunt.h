// SPDX-License-Identifier: Apache-2.0
// Guided search: rounds of libFuzzer (round.h) whose findings are stored as a campaign's are, with the one source
// `hunt`. The rounds of a generation start from the same corpus, which the generations before left: what comes of
// a hunt does not depend on how many of them run at once, nor on interruptions.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "fuzz/campaign/campaign.h"
#include "fuzz/hunt/mutations.h"

namespace graze::fuzz {

inline constexpr std::uint64_t kRoundsOfGeneration = 4;

struct Hunt {
  Campaign campaign;  // its one source is set by run_hunt
  Drawn drawn;        // where it starts, and what it draws again and again
  std::uint64_t pairs = 0;
  double seconds = 0;  // after which it stops; 0: none
};

struct HuntProgress {
  std::uint64_t done = 0, total = 0;  // pairs
  std::uint64_t done_here = 0;        // by this process
  double seconds = 0;                 // of this process
  std::size_t units = 0, signatures = 0, kinds = 0;
  std::size_t new_kinds = 0;      // by this process
  double seconds_since_kind = 0;  // since the last one, or the start
};

// What the store records of a hunt: as campaign_spec, with the source `hunt`, and under "hunt" what it draws from.
Json hunt_spec(const Hunt& hunt);

// The pairs of a round.
std::uint64_t round_pairs(std::uint64_t pairs);

// Runs or goes on with the hunt, or with a shard of it, until done, or its time is over, or `stop`; then writes
// hunt.json and timings.json, and of a whole one summary.json and cases/; status.json meanwhile. A shard is a search of
// its own, through its share of the pairs' numbers. Requires: has_libfuzzer(); no lane runs on a device. Throws:
// OracleMismatch, UsageError, std::runtime_error; committed rounds stay in any case.
Outcome run_hunt(Hunt& hunt, const std::atomic<bool>& stop, const std::function<void(const HuntProgress&)>& report);

}  // namespace graze::fuzz
