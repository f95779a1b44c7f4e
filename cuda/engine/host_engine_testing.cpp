// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/host_engine_testing.h"

#include <algorithm>
#include <bit>

#include "core/exact/exact.h"
#include "cuda/engine/engine_steps.h"

namespace graze::cuda {
namespace {

// Runs the steps of one block, pair by pair.
template <class Block>
struct HostRun {
  const Block& block;

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
      std::uint32_t open = 0;  // pairs with a known bucket that are not counted yet
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
      : on_host_(on_host.begin(), on_host.end()), row_of_(lanes.begin(), lanes.end()), limits_(limits) {}

  EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) override {
    groups_ = lane_groups(row_of_, source.in_doubles());
    return source.in_doubles() ? run_in<DoubleEngineBlock>(source, first, count)
                               : run_in<EngineBlock>(source, first, count);
  }

 private:
  template <class Block>
  EngineResult run_in(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) {
    const std::size_t counters = engine_counters<Block>(on_host_.size());
    const std::uint32_t block_pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(limits_.block_pairs, count));
    EngineTotals totals;
    const auto most_undecided = static_cast<std::uint32_t>(std::min<std::uint64_t>(limits_.undecided, count));
    totals.undecided.resize(most_undecided);
    totals.counts.resize(2 * counters + 1);
    Block block{};
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
          run_steps(block, HostRun<Block>{block});
        },
        [&] { return totals.left; });
    EngineResult result = result_of(std::move(totals), block.signatures, groups_, block.axis);
    result.done = done;
    return result;
  }

  void give_memory(EngineBlock& block, std::uint32_t pairs) {
    words_ = (pairs + 63) / 64;
    coordinates_.resize(std::size_t{pairs} * kCoordinates);
    bits_.assign(words_ * (2 * on_host_.size() + kColumns), 0);
    buckets_.resize(2 * std::size_t{pairs});
    relations_.resize(pairs);
    places_.resize(std::size_t{kEngineLists} * pairs);
    block.pairs = {coordinates_.data(), pairs, pairs};
    block.truth = words(kTruth);
    block.wrong = words(kWrong);
    block.buckets = buckets_.data();
    block.extremes = buckets_.data() + pairs;
    block.relations = relations_.data();
    lanes_.clear();
    for (std::size_t l = 0; l < on_host_.size(); ++l) {
      if (row_of_[l]->exact) {
        lanes_.push_back({words(kTruth), words(kNone)});  // the exact lane declines no pair
      } else {
        lanes_.push_back({words(of_lane(l)), words(of_lane(l) + 1)});
      }
    }
    block.lanes = {lanes_.data(), static_cast<std::uint32_t>(lanes_.size()), groups_.data(),
                   static_cast<std::uint32_t>(groups_.size())};
    for (std::size_t k = 0; k < kEngineLists; ++k) block.lists[k] = {&places_[k * pairs], &lengths_[k]};
  }

  void give_memory(DoubleEngineBlock& block, std::uint32_t pairs) {
    give_memory(static_cast<EngineBlock&>(block), pairs);
    doubles_.resize(std::size_t{pairs} * kCoordinates);
    block.doubles = {doubles_.data(), pairs, pairs};
    block.stored = {words(kStored), words(kBeyond)};
    block.changed = words(kChanged);
    changed_for_lane_.clear();
    for (std::size_t l = 0; l < on_host_.size(); ++l) {
      const bool of_stored = row_of_[l]->scalar == Scalar::f32;
      if (of_stored && row_of_[l]->exact) lanes_[l] = block.stored;
      changed_for_lane_.push_back(of_stored ? block.changed : nullptr);
    }
    block.changed_for_lane = changed_for_lane_.data();
  }

  // The first columns of bits_. After these columns, each lane has two more.
  enum { kTruth, kWrong, kNone, kStored, kBeyond, kChanged, kColumns };
  static std::size_t of_lane(std::size_t l) { return kColumns + 2 * l; }
  std::uint64_t* column(std::size_t k) { return &bits_[k * words_]; }
  std::uint32_t* words(std::size_t k) { return reinterpret_cast<std::uint32_t*>(column(k)); }

  // Draws the pairs, then decides them exactly and with the lanes.
  void decide(const EngineBlock& block, const strata::PairSource& source) {
    std::vector<Pair> pairs(block.pairs.count);
    for (std::uint32_t i = 0; i < block.pairs.count; ++i) pairs[i] = source.pair(block.first + i);
    put(pairs, coordinates_, block.pairs.stride);
    decide_exactly(pairs, kTruth, kNone);
    decide_by_lanes(pairs, [](const Lane&) { return true; });
    std::fill_n(lengths_, static_cast<std::size_t>(kEngineLists), 0u);
  }
  void decide(const DoubleEngineBlock& block, const strata::PairSource& source) {
    std::vector<DoublePair> doubles(block.pairs.count);
    std::vector<Pair> stored(block.pairs.count);
    for (std::uint32_t i = 0; i < block.pairs.count; ++i) {
      doubles[i] = source.double_pair(block.first + i);
      stored[i] = stored_in_float32(doubles[i]);
    }
    put(doubles, doubles_, block.doubles.stride);
    put(stored, coordinates_, block.pairs.stride);
    decide_exactly(doubles, kTruth, kNone);
    decide_exactly(stored, kStored, kBeyond);
    decide_by_lanes(doubles, [](const Lane& lane) { return lane.scalar == Scalar::f64; });
    decide_by_lanes(stored, [](const Lane& lane) { return lane.scalar == Scalar::f32; });
    std::fill_n(lengths_, static_cast<std::size_t>(kEngineLists), 0u);
  }

  template <class Real>
  static void put(const std::vector<BasicPair<Real>>& pairs, std::vector<Real>& columns, std::size_t stride) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t k = 0; k < kCoordinates; ++k) columns[k * stride + i] = coordinates(pairs[i])[k];
    }
  }

  template <class Real>
  void decide_exactly(const std::vector<BasicPair<Real>>& pairs, std::size_t intersects, std::size_t declined) {
    std::fill_n(column(intersects), words_, 0);
    std::fill_n(column(declined), words_, 0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Real* c = coordinates(pairs[i]);
      const bool finite = is_finite(pairs[i]);
      column(declined)[i / 64] |= std::uint64_t{!finite} << (i % 64);
      column(intersects)[i / 64] |= std::uint64_t{finite && exact::intersects(c, c + 9)} << (i % 64);
    }
  }

  // Decides the pairs with the lanes that `which` accepts.
  template <class AnyPair, class Which>
  void decide_by_lanes(const std::vector<AnyPair>& pairs, const Which& which) {
    for (std::size_t l = 0; l < on_host_.size(); ++l) {
      if (!row_of_[l]->exact && which(*row_of_[l]))
        on_host_[l](pairs.data(), pairs.size(), column(of_lane(l)), column(of_lane(l) + 1));
    }
  }

  std::vector<DecideBlock> on_host_;
  std::vector<const Lane*> row_of_;
  std::vector<LaneGroup> groups_;
  EngineLimits limits_;
  std::size_t words_ = 0;  // 64-bit words of a column of bits_
  std::vector<std::uint64_t> bits_;
  std::vector<float> coordinates_;
  std::vector<double> doubles_;
  std::vector<std::int8_t> buckets_;
  std::vector<std::uint16_t> relations_;
  std::vector<std::uint32_t> places_;
  std::uint32_t lengths_[kEngineLists] = {};
  std::vector<LaneWords> lanes_;
  std::vector<const std::uint32_t*> changed_for_lane_;
};

}  // namespace

std::unique_ptr<DeviceEngine> make_host_engine(std::span<const Lane* const> lanes, std::span<const DecideBlock> on_host,
                                               const EngineLimits& limits) {
  return std::make_unique<HostEngine>(lanes, on_host, limits);
}

}  // namespace graze::cuda
