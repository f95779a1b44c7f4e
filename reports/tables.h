// SPDX-License-Identifier: Apache-2.0
// The tables of a report, as reports/web/src/report.ts describes them, from a campaign's counts. Lanes and strata are
// named by their places; stratum null is all of them together.
#pragma once

#include <optional>

#include "reports/counts.h"
#include "reports/wilson.h"

namespace graze::reports {

// {"count", "of", "share", "low", "high"}, rounded to 5 significant digits, low and high outward.
nlohmann::ordered_json to_json(const Share& share);

nlohmann::ordered_json rates(const CampaignCounts& counts);

// Lanes of one algorithm of which one thing differs: cpu against cuda-nofma, which must be equal; cuda-nofma against
// cuda-fma; f32 against f64.
nlohmann::ordered_json side_by_side(const CampaignCounts& counts);

// On how many pairs a lane's verdict is not that of the other one. Nothing where the campaign did not count it.
std::optional<std::uint64_t> differs(const CampaignCounts& counts, const StratumCounts& stratum, std::size_t left,
                                     std::size_t right);

nlohmann::ordered_json margins(const CampaignCounts& counts);

// The least power of two of ulps from which on a lane was never wrong, on one side of zero.
struct Threshold {
  bool found = false;  // false: wrong at the largest margins seen, or none were seen
  int exponent = 0;
  std::uint64_t above = 0;     // pairs from there on
  std::optional<int> largest;  // exponent of the largest margins seen; nothing where no pair lies on that side
};
Threshold threshold(const StratumCounts& counts, std::size_t lane, int side);

// Of each group of strata, each stratum, and all of them together: the strata differ too much for one threshold.
nlohmann::ordered_json thresholds(const CampaignCounts& counts);

nlohmann::ordered_json groups(const CampaignCounts& counts);
nlohmann::ordered_json group_rates(const CampaignCounts& counts);
nlohmann::ordered_json extremes(const CampaignCounts& counts);

// Whether the pairs of a bucket intersect, are disjoint, or have no margin.
constexpr const char* side_of(Bucket bucket) { return bucket < 0 ? "intersects" : bucket > 0 ? "disjoint" : "zero"; }

// floor(log2) of the margins of a bucket other than 0, in ulps.
constexpr int exponent_of(Bucket bucket) { return (bucket < 0 ? -bucket : bucket) + kBucketLowest - 1; }

}  // namespace graze::reports
