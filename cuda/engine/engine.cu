// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/engine.h"

#include <algorithm>
#include <type_traits>

#include "cuda/engine/engine_kernels.cuh"
#include "cuda/engine/engine_run.h"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/stratum_kernels.cuh"

namespace graze::cuda {
namespace {

constexpr EngineLimits kLimits;
constexpr int kBlocksAtOnce = 3;

// The memory of one block. Several blocks run at once, because the last pairs of a block use only a few threads.
struct Buffers {
  Stream stream;
  Event done{cudaEventDisableTiming};  // recorded after the last block that used this memory
  PinnedArray<std::uint32_t> pinned;
  std::uint32_t* left = pinned.at_least(1);  // pairs that all blocks so far have left to the host
  DeviceExact exact;
  DeviceArray<float> coordinates;
  DeviceArray<double> doubles;
  DeviceArray<std::uint32_t> truth, wrong, stored, lane_words, places, lengths;
  DeviceArray<std::int8_t> buckets;
  DeviceArray<std::uint16_t> relations;
  DeviceArray<LaneWords> lanes;
  DeviceArray<const std::uint32_t*> changed_for_lane;
  std::vector<LaneWords> lanes_on_host;  // the contents of `lanes`
};

template <class Block>
constexpr bool kOfDoubles = std::is_same_v<Block, DoubleEngineBlock>;

class CudaEngine final : public DeviceEngine {
 public:
  CudaEngine(int ordinal, std::span<const Lane* const> lanes)
      : ordinal_(ordinal),
        lanes_(lanes.begin(), lanes.end()),
        groups_{lane_groups(lanes, false), lane_groups(lanes, true)} {
    check(cudaSetDevice(ordinal_));
    check(cudaSetDeviceFlags(cudaDeviceLmemResizeToMax));  // otherwise a kernel with a larger stack waits
    for (std::unique_ptr<Buffers>& buffers : buffers_) buffers = std::make_unique<Buffers>();
    for (const bool of_doubles : {false, true}) {
      const std::vector<LaneGroup>& of = groups_[of_doubles];
      LaneGroup* groups = groups_on_device_[of_doubles].at_least(of.size());
      check(cudaMemcpy(groups, of.data(), of.size() * sizeof *groups, cudaMemcpyHostToDevice));
    }
  }
  ~CudaEngine() override { cudaSetDevice(ordinal_); }

  EngineResult run(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) override {
    check(cudaSetDevice(ordinal_));
    return source.in_doubles() ? run_in<DoubleEngineBlock>(source, first, count)
                               : run_in<EngineBlock>(source, first, count);
  }

 private:
  template <class Block>
  EngineResult run_in(const strata::PairSource& source, std::uint64_t first, std::uint64_t count) {
    const Block empty = begin<Block>(source.axis);
    const std::uint32_t block_pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(kLimits.block_pairs, count));
    Block blocks[kBlocksAtOnce];
    for (int k = 0; k < kBlocksAtOnce; ++k) {
      blocks[k] = empty;
      give_memory(blocks[k], *buffers_[k], block_pairs);
      *buffers_[k]->left = 0;
    }
    const std::uint64_t done = run_blocks(
        kLimits, first, count,
        [&](int b, std::uint64_t at, std::uint32_t pairs) {
          Block& block = blocks[b % kBlocksAtOnce];
          block.pairs.count = block.pairs.stride = pairs;
          if constexpr (kOfDoubles<Block>) block.doubles.count = block.doubles.stride = pairs;
          block.first = at;
          judge(block, *buffers_[b % kBlocksAtOnce], source);
        },
        [&] { return may_be_left(block_pairs); });
    EngineResult result = fetch(empty);
    result.done = done;
    return result;
  }

  // Returns a block that has no memory for its pairs yet. Sets the counters, which all blocks of a run share, to zero.
  template <class Block>
  Block begin(Axis axis) {
    const std::vector<LaneGroup>& groups = groups_[kOfDoubles<Block>];
    const std::size_t counters = engine_counters<Block>(lanes_.size());
    Block block{};
    block.axis = axis;
    block.lanes.groups = groups_on_device_[kOfDoubles<Block>].at_least(0);
    block.lanes.group_count = static_cast<std::uint32_t>(groups.size());
    std::uint32_t* lengths = lengths_.at_least(2);
    block.undecided = {undecided_.at_least(kLimits.undecided), kLimits.undecided, lengths};
    SignatureTable& table = block.signatures;
    table = {nullptr, kLimits.signatures, key_words(groups), lengths + 1};
    table.rows = rows_.at_least(std::size_t{table.size} * table.row_words());
    block.counts = counts_.at_least(2 * counters + 1);
    block.extreme_counts = block.counts + counters;
    block.disagreements = block.counts + 2 * counters;
    check(cudaMemset(lengths, 0, 2 * sizeof *lengths));
    check(cudaMemset(block.counts, 0, (2 * counters + 1) * sizeof *block.counts));
    const std::size_t row_bytes = table.row_words() * sizeof *table.rows, case_bytes = kEngineCases * sizeof kNoCase;
    check(cudaMemset(table.rows, 0, table.size * row_bytes));
    check(cudaMemset2D(table.cases(table.rows), row_bytes, 0xff, case_bytes, table.size));  // kNoCase
    return block;
  }

  static std::size_t words_of(std::size_t pairs) { return (pairs + kThreads - 1) / kThreads * kThreads / 32; }

  void give_memory(EngineBlock& block, Buffers& buffers, std::size_t pairs) {
    const std::size_t words = words_of(pairs);
    block.pairs.coordinates = buffers.coordinates.at_least(pairs * kCoordinates);
    block.truth = buffers.truth.at_least(words);
    block.wrong = buffers.wrong.at_least(words);
    block.buckets = buffers.buckets.at_least(2 * pairs);
    block.extremes = block.buckets + pairs;
    block.relations = buffers.relations.at_least(pairs);
    std::uint32_t* of_lanes = buffers.lane_words.at_least(words * (2 * lanes_.size() + 1));
    std::uint32_t* none = of_lanes + words * 2 * lanes_.size();
    check(cudaMemset(none, 0, words * sizeof *none));
    buffers.lanes_on_host.clear();
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      if (lanes_[l]->exact) {  // the exact lane has the true verdicts, and declines no pair
        buffers.lanes_on_host.push_back({block.truth, none});
      } else {
        buffers.lanes_on_host.push_back({of_lanes + 2 * words * l, of_lanes + 2 * words * l + words});
      }
    }
    bring_lanes(block, buffers);
    std::uint32_t* places = buffers.places.at_least(kEngineLists * pairs);
    std::uint32_t* lengths = buffers.lengths.at_least(kEngineLists);
    for (int k = 0; k < kEngineLists; ++k) block.lists[k] = {places + pairs * static_cast<std::size_t>(k), lengths + k};
  }

  void bring_lanes(EngineBlock& block, Buffers& buffers) {
    LaneWords* table = buffers.lanes.at_least(lanes_.size());
    check(cudaMemcpy(table, buffers.lanes_on_host.data(), lanes_.size() * sizeof *table, cudaMemcpyHostToDevice));
    block.lanes.lanes = table;
    block.lanes.count = static_cast<std::uint32_t>(lanes_.size());
  }

  void give_memory(DoubleEngineBlock& block, Buffers& buffers, std::size_t pairs) {
    give_memory(static_cast<EngineBlock&>(block), buffers, pairs);
    const std::size_t words = words_of(pairs);
    block.doubles.coordinates = buffers.doubles.at_least(pairs * kCoordinates);
    std::uint32_t* stored = buffers.stored.at_least(3 * words);
    block.stored = {stored, stored + words};
    block.changed = stored + 2 * words;
    std::vector<const std::uint32_t*> changed;
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      const bool of_stored = lanes_[l]->scalar == Scalar::f32;
      if (of_stored && lanes_[l]->exact) buffers.lanes_on_host[l] = block.stored;
      changed.push_back(of_stored ? block.changed : nullptr);
    }
    bring_lanes(block, buffers);
    const std::uint32_t** for_lane = buffers.changed_for_lane.at_least(changed.size());
    check(cudaMemcpy(for_lane, changed.data(), changed.size() * sizeof *for_lane, cudaMemcpyHostToDevice));
    block.changed_for_lane = for_lane;
  }

  // Starts drawing the pairs and deciding them, both exactly and with the lanes. The pairs are finite, so the exact
  // decision declines none; its unused `declined` bits go to `wrong`, which a later step overwrites.
  void decide(const EngineBlock& block, Buffers& buffers, const strata::PairSource& source) {
    drawing_.draw(source, block.first, block.pairs.count, buffers.coordinates.at_least(0), buffers.stream);
    buffers.exact.decide(block.pairs, buffers.truth.at_least(0), block.wrong, nullptr, buffers.stream);
    for (std::size_t l = 0; l < lanes_.size(); ++l) decide_by(l, block.pairs, buffers);
  }
  void decide(const DoubleEngineBlock& block, Buffers& buffers, const strata::PairSource& source) {
    drawing_.draw(source, block.first, block.pairs.count, buffers.doubles.at_least(0), buffers.stream,
                  buffers.coordinates.at_least(0));
    buffers.exact.decide(block.doubles, buffers.truth.at_least(0), block.wrong, nullptr, buffers.stream);
    buffers.exact.decide(block.pairs, const_cast<std::uint32_t*>(block.stored.intersects),
                         const_cast<std::uint32_t*>(block.stored.declined), nullptr, buffers.stream);
    for (std::size_t l = 0; l < lanes_.size(); ++l)
      lanes_[l]->scalar == Scalar::f64 ? decide_by(l, block.doubles, buffers) : decide_by(l, block.pairs, buffers);
  }

  template <class Pairs>
  void decide_by(std::size_t l, const Pairs& pairs, Buffers& buffers) {
    const LaneWords& words = buffers.lanes_on_host[l];
    if (!lanes_[l]->exact)
      launch_lane(*lanes_[l], buffers.exact, pairs, const_cast<std::uint32_t*>(words.intersects),
                  const_cast<std::uint32_t*>(words.declined), buffers.stream);
  }

  template <class Block>
  void judge(const Block& block, Buffers& buffers, const strata::PairSource& source) {
    const cudaStream_t stream = buffers.stream;
    check(cudaEventSynchronize(buffers.done));  // limits the blocks in progress to the number of buffers
    decide(block, buffers, source);
    check(cudaMemsetAsync(block.lists[0].count, 0, kEngineLists * sizeof(std::uint32_t), stream));
    launch_engine(block, stream);
    check(cudaMemcpyAsync(buffers.left, block.undecided.count, sizeof *buffers.left, cudaMemcpyDeviceToHost, stream));
    check(cudaEventRecord(buffers.done, stream));
  }

  // An upper bound on the number of pairs left to the host so far. Does not wait for blocks in progress.
  std::uint32_t may_be_left(std::uint32_t block_pairs) const {
    std::uint32_t most = 0;
    for (const std::unique_ptr<Buffers>& buffers : buffers_) {
      const std::uint32_t left = *const_cast<const volatile std::uint32_t*>(buffers->left);
      most = std::max(most, left);
    }
    return most + kBlocksAtOnce * block_pairs;
  }

  template <class Block>
  EngineResult fetch(const Block& block) {
    std::uint32_t lengths[2];
    check(cudaMemcpy(lengths, block.undecided.count, sizeof lengths, cudaMemcpyDeviceToHost));
    EngineTotals totals{lengths[0], lengths[1], {}, {}, {}};
    const auto bring = [](std::vector<std::uint64_t>& to, const std::uint64_t* from, std::size_t count) {
      to.resize(count);
      check(cudaMemcpy(to.data(), from, count * sizeof *from, cudaMemcpyDeviceToHost));
    };
    bring(totals.undecided, block.undecided.indices, std::min(totals.left, kLimits.undecided));
    bring(totals.rows, block.signatures.rows, std::size_t{block.signatures.size} * block.signatures.row_words());
    bring(totals.counts, block.counts, 2 * engine_counters<Block>(lanes_.size()) + 1);
    return result_of(std::move(totals), block.signatures, groups_[kOfDoubles<Block>], block.axis);
  }

  int ordinal_;
  std::vector<const Lane*> lanes_;
  std::vector<LaneGroup> groups_[2];  // for float32 pairs, and for doubles
  Drawing drawing_;
  std::unique_ptr<Buffers> buffers_[kBlocksAtOnce];
  DeviceArray<LaneGroup> groups_on_device_[2];
  DeviceArray<std::uint32_t> lengths_;
  DeviceArray<std::uint64_t> undecided_, counts_, rows_;
};

}  // namespace

std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const> cuda_lanes) {
  std::vector<std::unique_ptr<DeviceEngine>> engines;
  for (int ordinal = 0; ordinal < count_devices(); ++ordinal)
    engines.push_back(std::make_unique<CudaEngine>(ordinal, cuda_lanes));
  return engines;
}

}  // namespace graze::cuda
