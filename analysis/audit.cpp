// SPDX-License-Identifier: Apache-2.0
#include "analysis/audit.h"

#include <algorithm>

namespace graze::analysis {
namespace {

Settled both(bool right_without, bool wrong_alone) {
  return !right_without ? Settled::not_without : wrong_alone ? Settled::yes : Settled::not_alone;
}

// Audits all contractions together, if their sites are not known, as with the host's compiler.
Settled of_all_contraction(const LaneExplanation& lane, const AnyPair& pair, Verdict truth) {
  const Lane& row = *lane.lane;
  if (lane.evidence == Evidence::none) return Settled::unknown;
  return both(run_led(row, pair, Contraction::none, {}).verdict == truth,
              oracle::run_limited(row.algorithm, row.scalar, pair.doubles, {}, lane.rule).verdict != truth);
}

Settled of_contraction(const LaneExplanation& lane, const AnyPair& pair, Verdict truth) {
  if (lane.contractions.sites.empty()) return of_all_contraction(lane, pair, truth);
  const std::span<const cuda::ContractionSite> all = cuda::contraction_sites(*lane.lane, pair);
  std::vector<std::uint64_t> named(all.size() / 64 + 1), others(all.size() / 64 + 1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_named =
        std::any_of(lane.contractions.sites.begin(), lane.contractions.sites.end(),
                    [&](const cuda::ContractionSite& site) { return site.ptx_line == all[i].ptx_line; });
    (is_named ? named : others)[i / 64] |= std::uint64_t{1} << (i % 64);
  }
  return both(cuda::decide_fusing(*lane.lane, pair, others) == truth,
              cuda::decide_fusing(*lane.lane, pair, named) != truth);
}

Settled of_range(const LaneExplanation& lane, const AnyPair& pair, Verdict truth) {
  const Lane& row = *lane.lane;
  const auto right_with = [&](oracle::Limits limits) {
    return oracle::run_limited(row.algorithm, row.scalar, pair.doubles, limits, lane.rule).verdict == truth;
  };
  const oracle::Limits alone{lane.cause == Cause::overflow, lane.cause == Cause::underflow};
  const oracle::Limits other{lane.cause == Cause::underflow, lane.cause == Cause::overflow};
  return both(right_with({}) && right_with(other),
              oracle::decide_exactly_but(row.algorithm, row.scalar, pair.doubles, lane.exactly.bits, alone) != truth);
}

Settled of_rounding(const LaneExplanation& lane, const AnyPair& pair, Verdict truth) {
  const Lane& row = *lane.lane;
  const Verdict corrected = run_led(row, pair, lane.rule, lane.deciding.back().corrected()).verdict;
  const Verdict alone = oracle::run_limited(row.algorithm, row.scalar, pair.doubles, {}, Contraction::none).verdict;
  return both(corrected == truth, alone != truth);
}

}  // namespace

Settled audit(const LaneExplanation& lane, const AnyPair& pair, Verdict truth) {
  if (lane.cause == Cause::logic) return both(true, lane.exactly.settled && lane.exactly.verdict != truth);
  if (lane.cause == Cause::fast_math) return Settled::unknown;
  if (lane.evidence != Evidence::none && lane.deciding.empty()) return Settled::not_by_few;
  if (lane.cause == Cause::contraction) return of_contraction(lane, pair, truth);
  if (lane.evidence == Evidence::none) return Settled::unknown;
  return lane.cause == Cause::rounding ? of_rounding(lane, pair, truth) : of_range(lane, pair, truth);
}

}  // namespace graze::analysis
