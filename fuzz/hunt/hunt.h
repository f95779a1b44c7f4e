// SPDX-License-Identifier: Apache-2.0
// Guided search: rounds of libFuzzer (round.h) whose findings are stored like a campaign's, with the single source
// `hunt`, or `hunt/f64` for pairs of doubles. All rounds of a generation start from the corpus that the earlier
// generations left. So the results do not depend on interruptions or on how many rounds run at once.
#pragma once

#include <atomic>
#include <functional>

#include "fuzz/campaign/campaign.h"
#include "fuzz/hunt/mutations.h"

namespace graze::fuzz {

inline constexpr std::uint64_t kRoundsOfGeneration = 4;

struct Hunt {
  Campaign campaign;  // run_hunt sets its single source
  Drawn drawn;        // the strata or the scene from which pairs are drawn
  std::uint64_t pairs = 0;
  double seconds = 0;  // time limit; 0: none
};

struct HuntProgress {
  std::uint64_t done = 0, total = 0;  // pairs
  std::uint64_t done_here = 0;        // pairs done by this process
  double seconds = 0;                 // of this process
  std::size_t units = 0, signatures = 0, kinds = 0;
  std::size_t new_kinds = 0;      // kinds found by this process
  double seconds_since_kind = 0;  // since the last new kind, or the start
};

// The spec that a hunt's store records: campaign_spec's, with the single source `hunt`. Its field "hunt" lists the
// strata from which the hunt draws.
Json hunt_spec(const Hunt& hunt);

// Runs or resumes the hunt, or a shard of it, until it is done, its time is up, or `stop` is set. Updates status.json
// as it runs. At the end it writes hunt.json and timings.json and, for a whole hunt, summary.json and cases/. A shard
// is an independent search with its share of the hunt's pairs.
// Requires: has_libfuzzer(); no lane runs on a device.
// Throws: OracleMismatch, UsageError, std::runtime_error. After an error, committed rounds are kept.
Outcome run_hunt(Hunt& hunt, const std::atomic<bool>& stop, const std::function<void(const HuntProgress&)>& report);

}  // namespace graze::fuzz
