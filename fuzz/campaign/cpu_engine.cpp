// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/cpu_engine.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "analysis/signature.h"
#include "oracle/truth.h"

namespace graze {
namespace {

constexpr std::size_t kBlockPairs = 1024;   // a task; a multiple of 64
constexpr std::uint64_t kGmpSample = 1024;  // GMP confirms one pair in so many, besides every disagreement

// Judges one block of pairs: host lanes, twins and oracle here, device lanes from their bits.
class BlockJudge {
 public:
  BlockJudge(const Campaign& campaign, int source, const std::vector<LaneBits>& device_bits)
      : campaign_(campaign), bench_(*campaign.bench), source_(source), device_bits_(device_bits) {
    host_bits_.resize(bench_.lanes.size());
    views_.resize(bench_.lanes.size());
    verdicts_.resize(bench_.lanes.size());
  }

  // `begin` is the first pair's place among the device lanes' bits.
  void judge(std::span<const Pair> pairs, std::span<const std::uint64_t> indices, std::size_t begin,
             BatchResult& result) {
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
        result.executors_apart[bench_.lanes[l]->id].add(CaseKey{indices[i], source_});
      }
    }

    const JudgedBlock block{pairs.size(), truth_, buckets_, views_};
    result.tally.add(block);
    if (const Axis axis = campaign_.sources[static_cast<std::size_t>(source_)].axis; axis != Axis::none) {
      extremes_.resize(pairs.size());
      for (std::size_t i = 0; i < pairs.size(); ++i) extremes_[i] = extreme_of(pairs[i], axis);
      result.extremes.add(JudgedBlock{pairs.size(), truth_, extremes_, views_});
    }
    const Bits wrong = disagreements(block);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::uint64_t index = indices[i];
      const bool disagreement = test_bit(wrong, i);
      if (!disagreement && index % kGmpSample != 0) continue;
      const bool intersects = test_bit(truth_, i);
      const Contact contact = gmp_contact(pairs[i]);
      ++result.gmp;
      if ((contact != Contact::none) != intersects) {
        throw OracleApart(
            fmt::format("the oracle's two decisions differ on {}:{}:{}: CGAL says {}, GMP says contact {}", source_id(),
                        campaign_.seed, index, intersects ? "intersects" : "disjoint", name(contact)));
      }
      if (!disagreement) continue;
      for (std::size_t l = 0; l < views_.size(); ++l) {
        verdicts_[l] = views_[l].at(i);
        if (bench_.lanes[l]->is_exact() && (verdicts_[l] == Verdict::intersects) != intersects) {
          throw OracleApart(fmt::format("{} and the oracle differ on {}:{}:{}: it says {}, the oracle {}",
                                        bench_.lanes[l]->id, source_id(), campaign_.seed, index, name(verdicts_[l]),
                                        intersects ? "intersects" : "disjoint"));
        }
      }
      ++result.disagreements;
      const Shape hulls = shape(pairs[i]);
      for_each_algorithm(bench_.lanes, [&](std::size_t first, std::size_t count) {
        const Signature failure =
            signature(contact, hulls, buckets_[i], intersects ? Verdict::intersects : Verdict::disjoint,
                      std::span(bench_.lanes).subspan(first, count), std::span(verdicts_).subspan(first, count));
        if (failure.wrong()) result.signatures[failure].add(CaseKey{index, source_});
      });
    }
  }

 private:
  const std::string& source_id() const { return campaign_.sources[static_cast<std::size_t>(source_)].id; }

  const Campaign& campaign_;
  const Bench& bench_;
  int source_;
  const std::vector<LaneBits>& device_bits_;
  Bits truth_;
  std::vector<Bucket> buckets_;
  std::vector<std::int8_t> extremes_;
  std::vector<LaneBits> host_bits_;
  std::vector<LaneVerdicts> views_;
  std::vector<Verdict> verdicts_;
};

}  // namespace

BatchResult judge(const Campaign& campaign, int source_number, std::size_t count,
                  const std::function<std::uint64_t(std::size_t)>& index_of) {
  const Source& source = campaign.sources[static_cast<std::size_t>(source_number)];
  std::vector<Pair> pairs(count);
  std::vector<std::uint64_t> indices(count);
  const std::size_t blocks = (count + kBlockPairs - 1) / kBlockPairs;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    for (std::size_t i = block * kBlockPairs; i < std::min(count, (block + 1) * kBlockPairs); ++i) {
      indices[i] = index_of(i);
      pairs[i] = source.pair(indices[i]);
    }
  });

  const std::vector<const Lane*> device_lanes = campaign.bench->device_lanes();
  std::vector<LaneBits> device_bits;
  if (!device_lanes.empty()) campaign.bench->device->decide(pairs, device_lanes, device_bits);

  const BatchResult empty(Tally(cpu_twins(campaign.bench->lanes)));
  tbb::enumerable_thread_specific<BatchResult> results(empty);
  tbb::enumerable_thread_specific<BlockJudge> judges([&] { return BlockJudge(campaign, source_number, device_bits); });
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t begin = block * kBlockPairs, size = std::min(count - begin, kBlockPairs);
    judges.local().judge(std::span(pairs).subspan(begin, size), std::span(indices).subspan(begin, size), begin,
                         results.local());
  });
  BatchResult total = empty;
  for (const BatchResult& part : results) total.add(part);
  return total;
}

}  // namespace graze
