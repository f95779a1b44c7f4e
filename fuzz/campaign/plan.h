// SPDX-License-Identifier: Apache-2.0
// Estimates a campaign's duration and disk use from the measured costs of each stratum's pairs, or from a given rate.
#pragma once

#include <optional>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// A size in bytes for the sample's pairs, and the exponent of its growth with the number of pairs.
struct Growing {
  double bytes = 0, exponent = 0;
};

// Measurements of each source on one core or one device.
struct Sample {
  std::vector<double> seconds_a_pair;  // of each source
  std::vector<Growing> row, summary;   // by source: a store row, and its pairs' part of summary.json
  std::uint64_t pairs = 0;             // in all samples
  std::uint64_t pairs_of_row = 1;      // pairs in each source's row
};

// Judges the first pairs of each source with the campaign's engines or one core. Takes some seconds.
Sample measure(const Campaign& campaign);

struct Plan {
  std::uint64_t pairs = 0, shards = 1;
  double rate = 0;           // pairs per second of one worker
  double seconds = 0;        // of all workers together
  double shard_seconds = 0;  // of one shard on one worker
  double shard_bytes = 0, merged_bytes = 0;
};

struct Workers {
  std::uint64_t count = 1;     // at least 1
  bool devices = false;        // GPUs, otherwise cores
  std::optional<double> rate;  // of each worker, instead of the sample's rate
};
Plan plan(const Campaign& campaign, const Sample& sample, const Workers& workers);

}  // namespace graze::fuzz
