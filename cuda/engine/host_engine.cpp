// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/host_engine.h"

#include <algorithm>
#include <bit>

#include "core/exact/exact.h"
#include "cuda/engine/engine_steps.h"

namespace graze::cuda {
namespace {

// Runs the steps of one block, pair by pair.
struct HostRun {
  const EngineBlock& block;

  std::uint32_t word_count() const { return (block.pairs.count + 31) / 32; }

  template <class Step>
  void take(Step step, std::uint32_t i) const {
    float c[kCoordinates];
    load(block.pairs, i, c);
    step(block, i, c);
  }
  template <class Step>
  void words(Step step) const {
    for (std::uint32_t word = 0; word < word_count(); ++word) step(block, word);
  }
  template <class Step>
  void pairs(Step step) const {
    for (std::uint32_t i = 0; i < block.pairs.count; ++i) take(step, i);
  }
  template <class Step>
  void pairs_by_verdict(Step step) const {
    pairs(step);
  }
  template <class Step>
  void listed(Step step, EngineList list) const {
    for (std::uint32_t n = 0; n < *block.lists[list].count; ++n) take(step, block.lists[list].at[n]);
  }
  void add_signatures(EngineList list) const {
    for (std::uint32_t n = 0; n < *block.lists[list].count; ++n) {
      const std::uint32_t i = block.lists[list].at[n];
      for (std::uint32_t g = 0; has_signatures(block, i) && g < block.lanes.group_count; ++g) {
        const SignatureKey key(block, g, i);
        if (key.any_wrong()) add_pair(block.signatures, key, block.first + i);
      }
    }
  }
  void tally(bool by_extreme) const {
    const std::int8_t* buckets = by_extreme ? block.extremes : block.buckets;
    std::uint64_t* into = by_extreme ? block.extreme_counts : block.counts;
    for (std::uint32_t word = 0; word < word_count(); ++word) {
      const std::uint32_t begin = word * 32, end = std::min(begin + 32, block.pairs.count);
      std::uint32_t open = 0;  // pairs of known buckets that are not counted yet
      for (std::uint32_t i = begin; i < end; ++i) open |= std::uint32_t{buckets[i] != kUndecided} << (i - begin);
      if (!by_extreme) add(block.disagreements, static_cast<std::uint64_t>(std::popcount(block.wrong[word] & open)));
      while (open) {
        const std::int8_t bucket = buckets[begin + static_cast<std::uint32_t>(std::countr_zero(open))];
        std::uint32_t same = 0;
        for (std::uint32_t i = begin; i < end; ++i) same |= std::uint32_t{buckets[i] == bucket} << (i - begin);
        count_word(block, word, same, 0, block.lanes.count, [&](std::uint32_t counter, std::uint32_t pairs) {
          add(&into[counter * kBucketCount + static_cast<std::uint32_t>(bucket + kBucketMost)],
              static_cast<std::uint64_t>(std::popcount(pairs)));
        });
        open &= ~same;
      }
    }
  }
};

class HostEngine final : public DeviceEngine {
 public:
  HostEngine(std::span<const Lane* const> lanes, std::span<const DecideBlock> on_host, const EngineLimits& limits)
      : on_host_(on_host.begin(), on_host.end()), groups_(lane_groups(lanes)), limits_(limits) {
    for (const Lane* lane : lanes) is_truth_.push_back(lane->exact);
  }

  EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) override {
    const std::size_t counters = engine_counters(on_host_.size());
    const std::uint32_t block_pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(limits_.block_pairs, count));
    EngineTotals totals;
    const auto most_undecided = static_cast<std::uint32_t>(std::min<std::uint64_t>(limits_.undecided, count));
    totals.undecided.resize(most_undecided);
    totals.counts.resize(2 * counters + 1);
    EngineBlock block{};
    block.axis = source.axis;
    block.signatures = {nullptr, limits_.signatures, key_words(groups_), &totals.full};
    totals.rows.resize(std::size_t{block.signatures.size} * block.signatures.row_words());
    block.signatures.rows = totals.rows.data();
    for (std::uint32_t at = 0; at < block.signatures.size; ++at)
      std::fill_n(block.signatures.cases(block.signatures.row(at)), kEngineCases, kNoCase);
    block.undecided = {totals.undecided.data(), most_undecided, &totals.left};
    block.counts = totals.counts.data();
    block.extreme_counts = block.counts + counters;
    block.disagreements = block.counts + 2 * counters;
    give_memory(block, block_pairs);
    const std::uint64_t done = run_blocks(
        limits_, first, count,
        [&](int, std::uint64_t at, std::uint32_t pairs) {
          block.first = at;
          block.pairs.count = pairs;
          decide(block, source);
          run_steps(block, HostRun{block});
        },
        [&] { return totals.left; });
    EngineResult result = result_of(std::move(totals), block.signatures, groups_, block.axis);
    result.done = done;
    return result;
  }

 private:
  void give_memory(EngineBlock& block, std::uint32_t pairs) {
    words_ = (pairs + 63) / 64;
    coordinates_.resize(std::size_t{pairs} * kCoordinates);
    bits_.assign(words_ * (2 * on_host_.size() + 3), 0);
    buckets_.resize(2 * std::size_t{pairs});
    relations_.resize(pairs);
    places_.resize(std::size_t{kEngineLists} * pairs);
    block.pairs = {coordinates_.data(), pairs, pairs};
    block.truth = words(0);
    block.wrong = words(1);
    block.buckets = buckets_.data();
    block.extremes = buckets_.data() + pairs;
    block.relations = relations_.data();
    lanes_.clear();
    for (std::size_t l = 0; l < on_host_.size(); ++l) {
      if (is_truth_[l]) {
        lanes_.push_back({words(0), words(2)});  // the exact lane declines nothing
      } else {
        lanes_.push_back({words(3 + 2 * l), words(4 + 2 * l)});
      }
    }
    block.lanes = {lanes_.data(), static_cast<std::uint32_t>(lanes_.size()), groups_.data(),
                   static_cast<std::uint32_t>(groups_.size())};
    for (std::size_t k = 0; k < kEngineLists; ++k) block.lists[k] = {&places_[k * pairs], &lengths_[k]};
  }

  std::uint32_t* words(std::size_t column) { return reinterpret_cast<std::uint32_t*>(&bits_[column * words_]); }

  // Draws the pairs, then decides them exactly and by the lanes.
  void decide(const EngineBlock& block, const strata::PairSource& source) {
    std::vector<Pair> pairs(block.pairs.count);
    std::fill_n(&bits_[0], words_, 0);
    for (std::uint32_t i = 0; i < block.pairs.count; ++i) {
      pairs[i] = source.pair(block.first + i);
      const float* c = coordinates(pairs[i]);
      for (std::size_t k = 0; k < kCoordinates; ++k) coordinates_[k * block.pairs.stride + i] = c[k];
      bits_[i / 64] |= std::uint64_t{exact::intersects(c, c + 9)} << (i % 64);
    }
    for (std::size_t l = 0; l < on_host_.size(); ++l) {
      if (!is_truth_[l])
        on_host_[l](pairs.data(), pairs.size(), &bits_[(3 + 2 * l) * words_], &bits_[(4 + 2 * l) * words_]);
    }
    std::fill_n(lengths_, static_cast<std::size_t>(kEngineLists), 0u);
  }

  std::vector<DecideBlock> on_host_;
  std::vector<bool> is_truth_;
  std::vector<LaneGroup> groups_;
  EngineLimits limits_;
  std::size_t words_ = 0;            // 64-bit words of a column of bits_
  std::vector<std::uint64_t> bits_;  // truth, wrong, none, then each lane's two columns
  std::vector<float> coordinates_;
  std::vector<std::int8_t> buckets_;
  std::vector<std::uint16_t> relations_;
  std::vector<std::uint32_t> places_;
  std::uint32_t lengths_[kEngineLists] = {};
  std::vector<LaneWords> lanes_;
};

}  // namespace

std::unique_ptr<DeviceEngine> make_host_engine(std::span<const Lane* const> lanes, std::span<const DecideBlock> on_host,
                                               const EngineLimits& limits) {
  return std::make_unique<HostEngine>(lanes, on_host, limits);
}

}  // namespace graze::cuda
