// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

#include "analysis/signature.h"
#include "build_info.h"
#include "fuzz/report_files.h"
#include "oracle/truth.h"

namespace graze {
namespace {

constexpr std::size_t kBatchPairs = 65536;  // a transaction
constexpr std::size_t kBlockPairs = 1024;   // a task; a multiple of 64
constexpr std::uint64_t kGmpSample = 1024;  // GMP confirms one pair in so many, besides every disagreement

struct Batch {
  int source;
  std::uint64_t first;
  std::size_t count;
};

// Round robin over the sources, so that a campaign cut short has seen all of them.
std::vector<Batch> make_batches(const std::vector<Source>& sources) {
  std::vector<Batch> batches;
  bool more = true;
  for (std::uint64_t first = 0; more; first += kBatchPairs) {
    more = false;
    for (std::size_t s = 0; s < sources.size(); ++s) {
      if (first >= sources[s].pairs) continue;
      batches.push_back({static_cast<int>(s), first,
                         static_cast<std::size_t>(std::min<std::uint64_t>(kBatchPairs, sources[s].pairs - first))});
      more = true;
    }
  }
  return batches;
}

// Judges one block of a batch: host lanes and oracle here, device lanes from the batch's bits.
class BlockJudge {
 public:
  BlockJudge(const Campaign& campaign, const std::vector<LaneBits>& device_bits)
      : campaign_(campaign), device_bits_(device_bits) {
    host_bits_.resize(campaign.lanes.size());
    views_.resize(campaign.lanes.size());
    verdicts_.resize(campaign.lanes.size());
  }

  void judge(const Batch& batch, std::size_t begin, std::span<const Pair> pairs, BatchResult& result) {
    const std::size_t words = (pairs.size() + 63) / 64;
    truth_.assign(words, 0);
    buckets_.resize(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Verdict verdict = cgal_verdict(pairs[i]);
      truth_[i / 64] |= std::uint64_t{verdict == Verdict::intersects} << (i % 64);
      buckets_[i] = margin_bucket(pairs[i], verdict);
    }
    result.cgal += pairs.size();

    std::size_t next_device = 0;
    for (std::size_t l = 0; l < campaign_.lanes.size(); ++l) {
      if (campaign_.lanes[l]->is_cuda()) {
        const LaneBits& bits = device_bits_[next_device++];
        views_[l] = {std::span(bits.intersects).subspan(begin / 64, words),
                     std::span(bits.declined).subspan(begin / 64, words)};
      } else {
        LaneBits& bits = host_bits_[l];
        bits.intersects.resize(words);
        bits.declined.resize(words);
        campaign_.lanes[l]->decide(pairs.data(), pairs.size(), bits.intersects.data(), bits.declined.data());
        views_[l] = {bits.intersects, bits.declined};
      }
    }

    const JudgedBlock block{pairs.size(), truth_, buckets_, views_};
    result.tally.add(block);
    const Bits wrong = disagreements(block);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::uint64_t index = batch.first + begin + i;
      const bool disagreement = test_bit(wrong, i);
      if (!disagreement && index % kGmpSample != 0) continue;
      const bool intersects = test_bit(truth_, i);
      const Contact contact = gmp_contact(pairs[i]);
      ++result.gmp;
      if ((contact != Contact::none) != intersects) {
        throw OracleApart(
            fmt::format("the oracle's two decisions differ on {}:{}:{}: CGAL says {}, GMP says contact {}",
                        campaign_.sources[static_cast<std::size_t>(batch.source)].id, campaign_.seed, index,
                        intersects ? "intersects" : "disjoint", name(contact)));
      }
      if (!disagreement) continue;
      for (std::size_t l = 0; l < views_.size(); ++l) verdicts_[l] = views_[l].at(i);
      ++result.disagreements;
      const Shape hulls = shape(pairs[i]);
      for_each_algorithm(campaign_.lanes, [&](std::size_t first, std::size_t count) {
        const Signature failure =
            signature(contact, hulls, buckets_[i], intersects ? Verdict::intersects : Verdict::disjoint,
                      std::span(campaign_.lanes).subspan(first, count), std::span(verdicts_).subspan(first, count));
        if (failure.wrong()) result.signatures[failure].add(CaseKey{index, batch.source});
      });
    }
  }

 private:
  const Campaign& campaign_;
  const std::vector<LaneBits>& device_bits_;
  Bits truth_;
  std::vector<Bucket> buckets_;
  std::vector<LaneBits> host_bits_;
  std::vector<LaneVerdicts> views_;
  std::vector<Verdict> verdicts_;
};

BatchResult run_batch(const Campaign& campaign, const Batch& batch, const std::vector<const Lane*>& cuda_lanes) {
  const Source& source = campaign.sources[static_cast<std::size_t>(batch.source)];
  std::vector<Pair> pairs(batch.count);
  const std::size_t blocks = (batch.count + kBlockPairs - 1) / kBlockPairs;
  const auto range_of = [&](std::size_t block) {
    return std::pair(block * kBlockPairs, std::min(batch.count, (block + 1) * kBlockPairs));
  };
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const auto [begin, end] = range_of(block);
    for (std::size_t i = begin; i < end; ++i) pairs[i] = source.pair(batch.first + i);
  });

  std::vector<LaneBits> device_bits;
  if (!cuda_lanes.empty()) campaign.device->decide(pairs, cuda_lanes, device_bits);

  const BatchResult empty(Tally(cpu_twins(campaign.lanes)));
  tbb::enumerable_thread_specific<BatchResult> results(empty);
  tbb::enumerable_thread_specific<BlockJudge> judges([&] { return BlockJudge(campaign, device_bits); });
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const auto [begin, end] = range_of(block);
    judges.local().judge(batch, begin, std::span(pairs).subspan(begin, end - begin), results.local());
  });
  BatchResult total = empty;
  for (const BatchResult& part : results) total.add(part);
  return total;
}

}  // namespace

Json campaign_spec(const Campaign& campaign) {
  Json strata = Json::array(), lane_ids = Json::array();
  std::uint64_t pairs = 0;
  for (const Source& source : campaign.sources) {
    strata.push_back(source.id);
    pairs += source.pairs;
  }
  for (const Lane* lane : campaign.lanes) lane_ids.push_back(lane->id);
  return {{"seed", campaign.seed}, {"pairs", pairs}, {"strata", strata}, {"lanes", lane_ids}};
}

Json build_info(const Device* device) {
  Json info = {{"version", GRAZE_VERSION},
               {"commit", GRAZE_COMMIT},
               {"compiler", GRAZE_COMPILER},
               {"cuda", nullptr},
               {"device", nullptr}};
  if (*GRAZE_NVCC) info["cuda"] = std::string("nvcc ") + GRAZE_NVCC;
  if (device) info["device"] = device->name + ", driver " + device->driver;
  return info;
}

Json run_campaign(const Campaign& campaign, const std::atomic<bool>& stop,
                  const std::function<void(const Progress&)>& report) {
  const auto start = std::chrono::steady_clock::now();
  const int threads = campaign.threads > 0 ? campaign.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  std::vector<const Lane*> cuda_lanes;
  std::copy_if(campaign.lanes.begin(), campaign.lanes.end(), std::back_inserter(cuda_lanes),
               [](const Lane* lane) { return lane->is_cuda(); });

  Store store(campaign.directory, campaign.spec, campaign.build);
  const std::vector<Batch> batches = make_batches(campaign.sources);
  Progress progress;
  progress.disagreements_of_source.resize(campaign.sources.size());
  for (std::size_t b = 0; b < batches.size(); ++b) {
    progress.total += batches[b].count;
    if (b < store.batches_done()) progress.done += batches[b].count;
  }
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  while (store.batches_done() < batches.size() && !stop) {
    const Batch& batch = batches[store.batches_done()];
    const BatchResult result = run_batch(campaign, batch, cuda_lanes);
    store.commit(batch.source, result);
    progress.done += batch.count;
    progress.done_here += batch.count;
    progress.seconds = seconds();
    progress.signatures = store.signature_count();
    progress.disagreements += result.disagreements;
    progress.disagreements_of_source[static_cast<std::size_t>(batch.source)] += result.disagreements;
    report(progress);
  }
  const Json summary = write_summary(campaign, store);
  append_timing(campaign.directory, {{"pairs", progress.done_here}, {"seconds", seconds()}, {"threads", threads}});
  return summary;
}

}  // namespace graze
