// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/changed_verdicts.h"

#include <algorithm>

#include "fuzz/campaign/checked_summary.h"

namespace graze::fuzz {
namespace {

std::uint64_t gap(std::uint64_t l, std::uint64_t r) { return l < r ? r - l : l - r; }

// Each changed verdict moves its pair from one count to another, or between a count and the right verdicts. A pair that
// a convention excuses may move although its verdict is unchanged, so the lower bound excludes such pairs.
void add_bounds(const Counts& before, const Counts& after, std::uint64_t pairs, ChangedVerdicts& to) {
  std::uint64_t moved = gap(before.not_true(), after.not_true());
  for (const auto field : {&Counts::false_positive, &Counts::false_negative, &Counts::declined, &Counts::crashed,
                           &Counts::timed_out, &Counts::unstable})
    moved += gap(before.*field, after.*field);
  const std::uint64_t excused = before.by_convention + after.by_convention, least = (moved + 1) / 2;
  to.least += least - std::min(least, excused);
  to.most += std::min(pairs, before.not_true() + after.not_true());
}

ChangedVerdicts compared(const StoredCounts& before, std::size_t lane_before, const StoredCounts& after,
                         std::size_t lane_after) {
  ChangedVerdicts found;
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const auto bucket = static_cast<Bucket>(b);
    const std::uint64_t pairs = after.tally.pairs(bucket);
    found.pairs += pairs;
    add_bounds(before.tally.lane(static_cast<int>(lane_before), bucket),
               after.tally.lane(static_cast<int>(lane_after), bucket), pairs, found);
  }
  using enum ChangedVerdicts::Known;
  if (before.digests.pairs == found.pairs && after.digests.pairs == found.pairs) {
    const bool equal = before.digests.of_lane[lane_before] == after.digests.of_lane[lane_after];
    found.known = equal ? same : changed;
    found.least = equal ? 0 : std::max<std::uint64_t>(found.least, 1);
    if (equal) found.most = 0;
  } else if (found.least > 0) {
    found.known = changed;
  } else if (found.most == 0) {  // every verdict was right
    found.known = same;
  }
  return found;
}

}  // namespace

std::vector<ChangedVerdicts> changed_verdicts(const std::filesystem::path& before, const std::filesystem::path& after) {
  const DatabaseCounts l = counts_of_database(before), r = counts_of_database(after);
  std::vector<ChangedVerdicts> all;
  for (std::size_t lane = 0; lane < r.store.lanes.size(); ++lane) {
    const auto lane_before = std::find(l.store.lanes.begin(), l.store.lanes.end(), r.store.lanes[lane]);
    if (lane_before == l.store.lanes.end()) continue;
    for (std::size_t s = 0; s < r.of_source.size(); ++s) {
      all.push_back(compared(l.of_source[s], static_cast<std::size_t>(lane_before - l.store.lanes.begin()),
                             r.of_source[s], lane));
      all.back().lane = r.store.lanes[lane];
      all.back().stratum = r.store.sources[s].id;
    }
  }
  return all;
}

}  // namespace graze::fuzz
