// SPDX-License-Identifier: Apache-2.0
// The tables of a report, as reports/web/src/report.ts describes them, made from a campaign's counts. Lanes and strata
// are given by index; a null stratum means all strata together.
#pragma once

#include <optional>

#include "core/wilson.h"
#include "reports/counts.h"

namespace graze::reports {

// {"count", "of", "share", "low", "high"}, rounded to 5 significant digits; low and high are rounded outward.
// to_json: the last three are null if `of` is 0.
nlohmann::ordered_json share_json(const Share& share);
nlohmann::ordered_json to_json(const Share& share);

nlohmann::ordered_json rates(const CampaignCounts& counts);

// Compares pairs of lanes of one algorithm that differ in one respect: cpu and cuda-nofma, which must agree; cuda-nofma
// and cuda-fma; f32 and f64.
nlohmann::ordered_json side_by_side(const CampaignCounts& counts);

// The number of pairs on which two lanes' verdicts differ. Nothing if the campaign did not count them.
std::optional<std::uint64_t> differs(const CampaignCounts& counts, const StratumCounts& stratum, std::size_t left,
                                     std::size_t right);

nlohmann::ordered_json margins(const CampaignCounts& counts);

// The smallest margin, a power of two in ulps, at or above which a lane was never wrong on one side of zero.
struct Threshold {
  bool found = false;          // false: wrong at the largest margins seen, or no margins were seen
  int exponent = 0;            // 1 above that of the largest margin with an error; else that of the smallest
  std::uint64_t above = 0;     // pairs with at least this margin
  std::optional<int> largest;  // exponent of the largest margins seen; nothing if no pair is on that side
};
Threshold threshold(const StratumCounts& counts, std::size_t lane, int side);
nlohmann::ordered_json to_json(const Threshold& threshold);

// Has thresholds for each group of strata, each stratum, and all strata together, because strata are too different to
// share one threshold.
nlohmann::ordered_json thresholds(const CampaignCounts& counts);

nlohmann::ordered_json groups(const CampaignCounts& counts);
nlohmann::ordered_json group_rates(const CampaignCounts& counts);
nlohmann::ordered_json extremes(const CampaignCounts& counts);

// Shows how the verdicts of one source differ between the compilers and processors of a campaign. Has a row for each
// algorithm and scalar. A row has a cell for each variant without a policy, with the share of verdicts that differ from
// the reference's and the share that are wrong. Variants that agree on every pair of every row form a group. The
// reference is x86-gcc, else cpu, else the first variant. For the JSON, see ToolchainMap in reports/web/src/report.ts.
//
// Two lanes of a subject differ on a pair exactly if the pair's signature marks them differently, so the signatures'
// counts suffice. A lane that declines pairs, or whose convention covers some, has no count, because not all of these
// pairs have a signature. signatures: as signature_rows returns them (failure_cards.h).   Returns: null if no toolchain
// ran.
nlohmann::ordered_json toolchain_map(const CampaignCounts& counts, const nlohmann::ordered_json& signatures);

// Whether a program built by a toolchain ran as a lane of the campaign.
bool has_toolchains(const CampaignCounts& counts);

// Whether a bucket's pairs intersect, are disjoint, or have margin zero.
constexpr const char* side_of(Bucket bucket) { return bucket < 0 ? "intersects" : bucket > 0 ? "disjoint" : "zero"; }

// floor(log2) of a bucket's margins in ulps.   Requires: a bucket other than 0.
constexpr int exponent_of(Bucket bucket) { return (bucket < 0 ? -bucket : bucket) + kBucketLowest - 1; }

}  // namespace graze::reports
