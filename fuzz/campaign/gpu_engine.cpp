// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/gpu_engine.h"

#include <algorithm>
#include <future>

#include "analysis/signature.h"
#include "cuda/engine/engine.h"
#include "fuzz/campaign/cpu_engine.h"

namespace graze::fuzz {
namespace {

static_assert(cuda::kEngineCases >= kKeptCases);

analysis::Signature signature_of(const cuda::EngineSignature& row, std::span<const Lane* const> lanes) {
  return analysis::signature(row.relation, row.nesting, row.bucket, lanes.subspan(row.lanes.first, row.lanes.count),
                             row.verdicts);
}

// Adds counts, which have the layout of EngineResult, to the tally.
void add(const std::vector<std::uint64_t>& counts, int lanes, bool of_doubles, analysis::Tally& tally) {
  const int of_lane = static_cast<int>(cuda::counters_of_lane(of_doubles));
  const auto counter = [&](int c, int b) {
    return counts[static_cast<std::size_t>(c * kBucketCount + b + kBucketMost)];
  };
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const auto bucket = static_cast<Bucket>(b);
    tally.add(bucket, counter(0, b), counter(1, b));
    for (int l = 0; l < lanes; ++l) {
      const int first = 2 + of_lane * l;
      analysis::LaneCounts of{{counter(first, b), counter(first + 1, b), counter(first + 2, b)}};
      if (of_doubles) of.stored = counter(first + 3, b);
      tally.add(bucket, l, of);  // differs_from_cpu is 0, because no cpu lane runs
    }
  }
}

void add(const cuda::EngineResult& found, int source, bool of_doubles, std::span<const Lane* const> lanes,
         BatchResult& result) {
  const int count = static_cast<int>(lanes.size());
  add(found.counts, count, of_doubles, result.tally);
  if (!found.extreme_counts.empty()) add(found.extreme_counts, count, of_doubles, result.extremes);
  for (int b = 0; b < kBucketCount; ++b) result.exact += found.counts[static_cast<std::size_t>(b)];
  for (const cuda::EngineSignature& row : found.signatures) {
    SignatureCount one;
    one.count = row.count;
    for (const std::uint64_t index : row.cases) one.cases.push_back({index, source});
    result.signatures[signature_of(row, lanes)].add(one);
  }
  result.disagreements += found.disagreements;
}

}  // namespace

BatchResult judge_on_devices(const Campaign& campaign, const PairRange& range, Confirmation& confirmation) {
  const strata::PairSource& source = campaign.sources[static_cast<std::size_t>(range.source)];
  const std::size_t engines = campaign.engines.size();
  std::vector<std::future<std::vector<cuda::EngineResult>>> runs;
  for (std::size_t e = 0; e < engines; ++e) {
    const std::uint64_t begin = range.pairs * e / engines, end = range.pairs * (e + 1) / engines;
    runs.push_back(std::async(std::launch::async, [&, e, begin, end] {
      std::vector<cuda::EngineResult> parts;
      for (std::uint64_t at = begin; at < end; at += parts.back().done) {
        parts.push_back(campaign.engines[e]->run(source, range.first + at, end - at));
      }
      return parts;
    }));
  }
  const std::vector<const Lane*>& lanes = campaign.under_test->lanes;
  BatchResult result = no_counts(campaign);
  std::vector<std::uint64_t> undecided;
  for (auto& run : runs) {
    for (const cuda::EngineResult& found : run.get()) {
      add(found, range.source, source.in_doubles(), lanes, result);
      undecided.insert(undecided.end(), found.undecided.begin(), found.undecided.end());
    }
  }
  confirmation.confirm(range.source, result);
  constexpr std::size_t kAtOnce = 65536;
  for (std::size_t at = 0; at < undecided.size(); at += kAtOnce) {
    result.add(judge(campaign, range.source, std::min(kAtOnce, undecided.size() - at),
                     [&](std::size_t i) { return undecided[at + i]; }));
  }
  return result;
}

}  // namespace graze::fuzz
