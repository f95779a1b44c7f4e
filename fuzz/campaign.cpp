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
#include <optional>

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

// The batches in order, one after the other: round robin over the sources, so that a campaign cut short has seen all
// of them. Computed as it goes, so that the largest campaign takes no more memory than the smallest.
class Batches {
 public:
  explicit Batches(const std::vector<Source>& sources) : sources_(sources) {}

  std::optional<Batch> next() {
    for (std::size_t passed = 0; passed < sources_.size(); ++passed) {
      const std::size_t s = source_;
      const std::uint64_t first = first_;
      if (++source_ == sources_.size()) {
        source_ = 0;
        first_ += kBatchPairs;
      }
      if (first < sources_[s].pairs) {
        const std::uint64_t left = sources_[s].pairs - first;
        return Batch{static_cast<int>(s), first, static_cast<std::size_t>(std::min<std::uint64_t>(kBatchPairs, left))};
      }
    }
    return std::nullopt;
  }

 private:
  const std::vector<Source>& sources_;
  std::size_t source_ = 0;
  std::uint64_t first_ = 0;
};

// Judges one block of a batch: host lanes, twins and oracle here, device lanes from the batch's bits.
class BlockJudge {
 public:
  BlockJudge(const Campaign& campaign, const std::vector<LaneBits>& device_bits)
      : campaign_(campaign), bench_(*campaign.bench), device_bits_(device_bits) {
    host_bits_.resize(bench_.lanes.size());
    views_.resize(bench_.lanes.size());
    verdicts_.resize(bench_.lanes.size());
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
    for (std::size_t l = 0; l < bench_.lanes.size(); ++l) {
      if (bench_.on_host[l]) {
        LaneBits& bits = host_bits_[l];
        bits.intersects.resize(words);
        bits.declined.resize(words);
        bench_.on_host[l](pairs.data(), pairs.size(), bits.intersects.data(), bits.declined.data());
        views_[l] = {bits.intersects, bits.declined};
      }
      if (!bench_.on_device(l)) continue;
      const LaneBits& bits = device_bits_[next_device++];
      const LaneVerdicts twin = views_[l];
      views_[l] = {std::span(bits.intersects).subspan(begin / 64, words),
                   std::span(bits.declined).subspan(begin / 64, words)};
      for (std::size_t i = 0; bench_.on_both(l) && i < pairs.size(); ++i) {
        if (views_[l].at(i) == twin.at(i)) continue;
        result.executors_apart[bench_.lanes[l]->id].add(CaseKey{batch.first + begin + i, batch.source});
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
        throw OracleApart(fmt::format(
            "the oracle's two decisions differ on {}:{}:{}: CGAL says {}, GMP says contact {}", source_id(batch),
            campaign_.seed, index, intersects ? "intersects" : "disjoint", name(contact)));
      }
      if (!disagreement) continue;
      for (std::size_t l = 0; l < views_.size(); ++l) {
        verdicts_[l] = views_[l].at(i);
        if (bench_.lanes[l]->is_exact() && (verdicts_[l] == Verdict::intersects) != intersects) {
          throw OracleApart(fmt::format("{} and the oracle differ on {}:{}:{}: it says {}, the oracle {}",
                                        bench_.lanes[l]->id, source_id(batch), campaign_.seed, index,
                                        name(verdicts_[l]), intersects ? "intersects" : "disjoint"));
        }
      }
      ++result.disagreements;
      const Shape hulls = shape(pairs[i]);
      for_each_algorithm(bench_.lanes, [&](std::size_t first, std::size_t count) {
        const Signature failure =
            signature(contact, hulls, buckets_[i], intersects ? Verdict::intersects : Verdict::disjoint,
                      std::span(bench_.lanes).subspan(first, count), std::span(verdicts_).subspan(first, count));
        if (failure.wrong()) result.signatures[failure].add(CaseKey{index, batch.source});
      });
    }
  }

 private:
  const std::string& source_id(const Batch& batch) const {
    return campaign_.sources[static_cast<std::size_t>(batch.source)].id;
  }

  const Campaign& campaign_;
  const Bench& bench_;
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
  if (!cuda_lanes.empty()) campaign.bench->device->decide(pairs, cuda_lanes, device_bits);

  const BatchResult empty(Tally(cpu_twins(campaign.bench->lanes)));
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
  for (const Lane* lane : campaign.bench->lanes) lane_ids.push_back(lane->id);
  return {{"seed", campaign.seed}, {"pairs", pairs}, {"strata", strata}, {"lanes", lane_ids}};
}

Json build_info(const Bench& bench) {
  Json info = {{"version", GRAZE_VERSION},
               {"commit", GRAZE_COMMIT},
               {"compiler", GRAZE_COMPILER},
               {"cuda", nullptr},
               {"device", nullptr}};
  if (*GRAZE_NVCC) info["cuda"] = std::string("nvcc ") + GRAZE_NVCC;
  if (bench.device) info["device"] = bench.device->name + ", driver " + bench.device->driver;
  info["executors"] = Json::object();
  for (std::size_t l = 0; l < bench.lanes.size(); ++l) {
    if (bench.lanes[l]->is_cuda()) info["executors"][bench.lanes[l]->id] = bench.evidence(l);
  }
  return info;
}

Json run_campaign(const Campaign& campaign, const std::atomic<bool>& stop,
                  const std::function<void(const Progress&)>& report) {
  const auto start = std::chrono::steady_clock::now();
  const int threads = campaign.threads > 0 ? campaign.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const std::vector<const Lane*> cuda_lanes = campaign.bench->device_lanes();

  Store store(campaign.directory, campaign.spec, campaign.build);
  Batches batches(campaign.sources);
  Progress progress;
  progress.disagreements_of_source.resize(campaign.sources.size());
  for (const Source& source : campaign.sources) progress.total += source.pairs;
  for (std::uint64_t b = 0; b < store.batches_done(); ++b) progress.done += batches.next()->count;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  while (!stop) {
    const std::optional<Batch> batch = batches.next();
    if (!batch) break;
    const BatchResult result = run_batch(campaign, *batch, cuda_lanes);
    store.commit(batch->source, result);
    progress.done += batch->count;
    progress.done_here += batch->count;
    progress.seconds = seconds();
    progress.signatures = store.signature_count();
    progress.disagreements += result.disagreements;
    progress.disagreements_of_source[static_cast<std::size_t>(batch->source)] += result.disagreements;
    report(progress);
  }
  const Json summary = write_summary(campaign, store, progress.done == progress.total);
  append_timing(campaign.directory, {{"pairs", progress.done_here}, {"seconds", seconds()}, {"threads", threads}});
  return summary;
}

}  // namespace graze
