// SPDX-License-Identifier: Apache-2.0
// How long a campaign takes, and how much disk: from what its pairs cost here, stratum by stratum, or from a given
// rate.
#pragma once

#include <optional>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// What was measured of each source, by one core or one device.
struct Sample {
  std::vector<double> seconds_a_pair;  // of each source
  std::vector<double> row_bytes;       // of each source's row in the store, of a sample's pairs
  std::vector<double> row_growth;      // the exponent by which it grows with the pairs
  std::uint64_t pairs = 0;             // all samples
  std::uint64_t pairs_of_row = 1;      // those of each source's row
};

// Judges the first pairs of each source, by the campaign's engines or one core: some seconds.
Sample measure(const Campaign& campaign);

struct Plan {
  std::uint64_t pairs = 0, shards = 1;
  double rate = 0;           // pairs a second of one worker
  double seconds = 0;        // of all workers together
  double shard_seconds = 0;  // of one shard on one worker
  double shard_bytes = 0, merged_bytes = 0;
};

struct Workers {
  std::uint64_t count = 1;     // at least
  bool devices = false;        // GPUs; else cores
  std::optional<double> rate;  // of each, instead of the sample's
};
Plan plan(const Campaign& campaign, const Sample& sample, const Workers& workers);

}  // namespace graze::fuzz
