// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/cpu_engine.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "analysis/convention.h"
#include "analysis/signature.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kBlockPairs = 1024;   // a task, or less where there are few pairs; a multiple of 64
constexpr std::uint64_t kGmpSample = 1024;  // GMP confirms one pair in so many, besides every disagreement

// Judges one block of pairs: host lanes, twins and oracle here, device lanes from their bits.
class BlockJudge {
 public:
  BlockJudge(const Campaign& campaign, int source, const std::vector<cuda::LaneBits>& device_bits)
      : campaign_(campaign), under_test_(*campaign.under_test), source_(source), device_bits_(device_bits) {
    host_bits_.resize(under_test_.lanes.size());
    views_.resize(under_test_.lanes.size());
    verdicts_.resize(under_test_.lanes.size());
  }

  // `begin` is the first pair's place among the device lanes' bits.
  void judge(std::span<const Pair> pairs, std::span<const std::uint64_t> indices, std::size_t begin,
             BatchResult& result, PairJudge::Found* found = nullptr) {
    const std::size_t words = (pairs.size() + 63) / 64;
    truth_.assign(words, 0);
    buckets_.resize(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Verdict verdict = oracle::cgal_verdict(pairs[i]);
      truth_[i / 64] |= std::uint64_t{verdict == Verdict::intersects} << (i % 64);
      buckets_[i] = oracle::margin_bucket(pairs[i], verdict);
    }
    result.cgal += pairs.size();

    std::size_t next_device = 0;
    for (std::size_t l = 0; l < under_test_.lanes.size(); ++l) {
      if (under_test_.on_host[l]) {
        cuda::LaneBits& bits = host_bits_[l];
        bits.intersects.resize(words);
        bits.declined.resize(words);
        under_test_.on_host[l](pairs.data(), pairs.size(), bits.intersects.data(), bits.declined.data());
        views_[l] = {bits.intersects, bits.declined, nullptr, pairs.data()};
        if (under_test_.lanes[l]->foreign) views_[l].foreign = &under_test_.on_host[l];
      }
      if (!under_test_.on_device(l)) continue;
      const cuda::LaneBits& bits = device_bits_[next_device++];
      const analysis::LaneVerdicts twin = views_[l];
      views_[l] = {std::span(bits.intersects).subspan(begin / 64, words),
                   std::span(bits.declined).subspan(begin / 64, words)};
      for (std::size_t i = 0; under_test_.on_both(l) && i < pairs.size(); ++i) {
        if (views_[l].at(i) == twin.at(i)) continue;
        result.executors_apart[under_test_.lanes[l]->id].add(CaseKey{indices[i], source_});
      }
    }

    const analysis::JudgedBlock block{pairs.size(), truth_, buckets_, views_};
    result.tally.add(block);
    if (const Axis axis = campaign_.sources[static_cast<std::size_t>(source_)].axis; axis != Axis::none) {
      extremes_.resize(pairs.size());
      for (std::size_t i = 0; i < pairs.size(); ++i) extremes_[i] = place_on_axis(pairs[i], axis);
      result.extremes.add(analysis::JudgedBlock{pairs.size(), truth_, extremes_, views_});
    }
    const analysis::Bits wrong = analysis::disagreements(block);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::uint64_t index = indices[i];
      const bool disagreement = analysis::test_bit(wrong, i);
      if (!disagreement && index % kGmpSample != 0) continue;
      const bool intersects = analysis::test_bit(truth_, i);
      const Contact contact = oracle::gmp_contact(pairs[i]);
      ++result.gmp;
      if ((contact != Contact::none) != intersects) {
        throw oracle::OracleApart(
            fmt::format("the oracle's two decisions differ on {}:{}:{}: CGAL says {}, GMP says contact {}", source_id(),
                        campaign_.seed, index, intersects ? "intersects" : "disjoint", name(contact)));
      }
      if (!disagreement) continue;
      const Verdict truth = intersects ? Verdict::intersects : Verdict::disjoint;
      const oracle::Shape hulls = oracle::shape(pairs[i]);
      bool any_wrong = false;
      for (std::size_t l = 0; l < views_.size(); ++l) {
        verdicts_[l] = views_[l].at(i);
        if (under_test_.lanes[l]->exact && (verdicts_[l] == Verdict::intersects) != intersects) {
          throw oracle::OracleApart(fmt::format("{} and the oracle differ on {}:{}:{}: it says {}, the oracle {}",
                                                under_test_.lanes[l]->id, source_id(), campaign_.seed, index,
                                                name(verdicts_[l]), intersects ? "intersects" : "disjoint"));
        }
        if (verdicts_[l] == truth) continue;
        if (analysis::by_convention(*under_test_.lanes[l], verdicts_[l], pairs[i], contact, hulls, buckets_[i] == 0)) {
          result.tally.excuse(buckets_[i], static_cast<int>(l), verdicts_[l]);
          if (campaign_.sources[static_cast<std::size_t>(source_)].axis != Axis::none)
            result.extremes.excuse(extremes_[i], static_cast<int>(l), verdicts_[l]);
          verdicts_[l] = truth;
          continue;
        }
        any_wrong = true;
      }
      if (!any_wrong) continue;
      ++result.disagreements;
      analysis::for_each_subject(under_test_.lanes, [&](std::size_t first, std::size_t count) {
        const analysis::Signature failure = analysis::signature(
            contact, hulls, buckets_[i], truth,
            std::span(under_test_.lanes).subspan(first, count), std::span(verdicts_).subspan(first, count));
        if (!failure.wrong()) return;
        result.signatures[failure].add(CaseKey{index, source_});
        if (found) found->failures.push_back(failure);
      });
    }
    if (!found) return;
    found->truth = analysis::test_bit(truth_, 0) ? Verdict::intersects : Verdict::disjoint;
    found->bucket = buckets_[0];
    if (!analysis::test_bit(wrong, 0)) verdicts_.assign(views_.size(), found->truth);
    found->verdicts = verdicts_;
  }

 private:
  const std::string& source_id() const { return campaign_.sources[static_cast<std::size_t>(source_)].id; }

  const Campaign& campaign_;
  const LanesUnderTest& under_test_;
  int source_;
  const std::vector<cuda::LaneBits>& device_bits_;
  analysis::Bits truth_;
  std::vector<Bucket> buckets_;
  std::vector<std::int8_t> extremes_;
  std::vector<cuda::LaneBits> host_bits_;
  std::vector<analysis::LaneVerdicts> views_;
  std::vector<Verdict> verdicts_;
};

}  // namespace

struct PairJudge::Parts {
  explicit Parts(const Campaign& campaign) : judge(campaign, 0, device_bits) {}

  std::vector<cuda::LaneBits> device_bits;
  BlockJudge judge;
  Found found{};
};

PairJudge::PairJudge(const Campaign& campaign) : parts_(std::make_unique<Parts>(campaign)) {}
PairJudge::~PairJudge() = default;

const PairJudge::Found& PairJudge::judge(const Pair& pair, std::uint64_t index, BatchResult& total) {
  parts_->found.failures.clear();
  parts_->judge.judge({&pair, 1}, {&index, 1}, 0, total, &parts_->found);
  return parts_->found;
}

BatchResult no_counts(const Campaign& campaign) {
  return BatchResult(analysis::Tally(analysis::cpu_twins(campaign.under_test->lanes)));
}

BatchResult judge(const Campaign& campaign, int source_number, std::size_t count,
                  const std::function<std::uint64_t(std::size_t)>& index_of) {
  const strata::PairSource& source = campaign.sources[static_cast<std::size_t>(source_number)];
  std::vector<Pair> pairs(count);
  std::vector<std::uint64_t> indices(count);
  const std::size_t block_pairs = std::clamp(count / 16 / 64 * 64, std::size_t{64}, kBlockPairs);
  const std::size_t blocks = (count + block_pairs - 1) / block_pairs;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    for (std::size_t i = block * block_pairs; i < std::min(count, (block + 1) * block_pairs); ++i) {
      indices[i] = index_of(i);
      pairs[i] = source.pair(indices[i]);
    }
  });

  const std::vector<const Lane*> device_lanes = campaign.under_test->device_lanes();
  std::vector<cuda::LaneBits> device_bits;
  if (!device_lanes.empty()) campaign.under_test->device->decide(pairs, device_lanes, device_bits);

  const BatchResult empty = no_counts(campaign);
  tbb::enumerable_thread_specific<BatchResult> results(empty);
  tbb::enumerable_thread_specific<BlockJudge> judges([&] { return BlockJudge(campaign, source_number, device_bits); });
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t begin = block * block_pairs, size = std::min(count - begin, block_pairs);
    judges.local().judge(std::span(pairs).subspan(begin, size), std::span(indices).subspan(begin, size), begin,
                         results.local());
  });
  BatchResult total = empty;
  for (const BatchResult& part : results) total.add(part);
  return total;
}

}  // namespace graze::fuzz
