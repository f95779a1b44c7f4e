// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/engine.h"

#include <algorithm>

#include "cuda/engine/engine_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/stratum_kernels.cuh"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

constexpr std::uint32_t kBlockPairs = 1u << 22;  // decided together; a multiple of kThreads
constexpr std::uint32_t kSignatures = 1u << 18;  // a million pairs of all strata make six thousand
constexpr std::uint32_t kMostUndecided = 1u << 26;
constexpr int kBlocksAtOnce = 3;
constexpr int kBlocksBetweenLooks = 12;

// The memory of one block under way. Several are, so that the last pairs of one, which keep few threads busy, do not
// hold up the next.
struct Buffers {
  cudaStream_t stream;
  DeviceExact exact;
  DeviceArray<float> coordinates;
  DeviceArray<std::uint32_t> truth, wrong, lane_words, places, lengths;
  DeviceArray<std::int8_t> buckets;

  Buffers() { check(cudaStreamCreate(&stream)); }
  ~Buffers() { cudaStreamDestroy(stream); }
};

class CudaEngine final : public DeviceEngine {
 public:
  CudaEngine(int ordinal, std::span<const Lane* const> lanes) : ordinal_(ordinal), lanes_(lanes.begin(), lanes.end()) {
    if (lanes.size() > kMostLanes) throw std::runtime_error("the engine takes 32 lanes at most");
    check(cudaSetDevice(ordinal_));
    check(cudaSetDeviceFlags(cudaDeviceLmemResizeToMax));  // else each kernel with a stack of its own size waits for it
    for (std::unique_ptr<Buffers>& buffers : buffers_) buffers = std::make_unique<Buffers>();
  }
  ~CudaEngine() override { cudaSetDevice(ordinal_); }

  EngineResult run(std::uint64_t seed, int stratum, std::uint64_t first, std::uint64_t count) override {
    check(cudaSetDevice(ordinal_));
    const EngineBlock empty = begin(strata::kStrata[stratum].axis);
    const std::uint32_t block_pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlockPairs, count));
    EngineBlock blocks[kBlocksAtOnce];
    for (int k = 0; k < kBlocksAtOnce; ++k) blocks[k] = with_memory(empty, *buffers_[k], block_pairs);
    std::uint64_t done = 0;
    for (int b = 0; done < count; ++b) {
      EngineBlock& block = blocks[b % kBlocksAtOnce];
      block.pairs.count = static_cast<std::uint32_t>(std::min<std::uint64_t>(block_pairs, count - done));
      block.pairs.stride = block.pairs.count;
      block.first = first + done;
      judge(block, *buffers_[b % kBlocksAtOnce], seed, stratum);
      done += block.pairs.count;
      if ((b + 1) % kBlocksBetweenLooks == 0 &&
          left_to_host(empty) > kMostUndecided - kBlocksBetweenLooks * kBlockPairs)
        break;
    }
    EngineResult result = fetch(empty);
    result.done = done;
    return result;
  }

 private:
  // Empties what adds up over the blocks.
  EngineBlock begin(Axis axis) {
    EngineBlock block{};
    block.axis = axis;
    std::uint32_t* lengths = lengths_.at_least(2);
    block.undecided = {undecided_.at_least(kMostUndecided), kMostUndecided, lengths};
    block.signatures = {signatures_.at_least(kSignatures), kSignatures, lengths + 1};
    block.counts = counts_.at_least(2 * counters() + 1);
    block.extreme_counts = block.counts + counters();
    block.disagreements = block.counts + 2 * counters();
    check(cudaMemset(lengths, 0, 2 * sizeof *lengths));
    check(cudaMemset(block.counts, 0, (2 * counters() + 1) * sizeof *block.counts));
    std::vector<EngineSignature> empty(kSignatures);
    for (EngineSignature& row : empty) std::fill_n(row.cases, kEngineCases, ~std::uint64_t{0});
    check(cudaMemcpy(block.signatures.rows, empty.data(), empty.size() * sizeof empty[0], cudaMemcpyHostToDevice));
    return block;
  }

  EngineBlock with_memory(EngineBlock block, Buffers& buffers, std::size_t pairs) {
    const std::size_t words = (pairs + kThreads - 1) / kThreads * kThreads / 32;
    block.pairs.coordinates = buffers.coordinates.at_least(pairs * kCoordinates);
    block.truth = buffers.truth.at_least(words);
    block.wrong = buffers.wrong.at_least(words);
    block.buckets = buffers.buckets.at_least(2 * pairs);
    block.extremes = block.buckets + pairs;
    block.lanes.count = static_cast<int>(lanes_.size());
    std::uint32_t* of_lanes = buffers.lane_words.at_least(words * (2 * lanes_.size() + 1));
    std::uint32_t* none = of_lanes + words * 2 * lanes_.size();
    check(cudaMemset(none, 0, words * sizeof *none));
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      const Lane& lane = *lanes_[l];
      if (lane.is_exact()) {  // it is the truth, and declines nothing
        block.lanes.lane[l] = {block.truth, none, lane.algorithm, -1};
        continue;
      }
      const int slot = static_cast<int>(lane.scalar) * kTargetCount + static_cast<int>(lane.target);
      block.lanes.lane[l] = {of_lanes + 2 * words * l, of_lanes + 2 * words * l + words, lane.algorithm, slot};
    }
    std::uint32_t* places = buffers.places.at_least(kEngineLists * pairs);
    std::uint32_t* lengths = buffers.lengths.at_least(kEngineLists);
    for (int k = 0; k < kEngineLists; ++k) block.lists[k] = {places + pairs * static_cast<std::size_t>(k), lengths + k};
    return block;
  }

  void judge(const EngineBlock& block, Buffers& buffers, std::uint64_t seed, int stratum) {
    const cudaStream_t stream = buffers.stream;
    launch_generate(buffers.coordinates.at_least(0), block.pairs.count, seed, stratum, block.first, stream);
    std::uint32_t* truth = buffers.truth.at_least(0);
    // No stratum has pairs that are not finite: nothing is declined, and `wrong` is free until it is written.
    buffers.exact.decide(block.pairs, truth, block.wrong, nullptr, stream);
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      const LaneWords& words = block.lanes.lane[l];
      if (words.intersects == truth) continue;
      launch_lane(*lanes_[l], buffers.exact, block.pairs, const_cast<std::uint32_t*>(words.intersects),
                  const_cast<std::uint32_t*>(words.declined), stream);
    }
    check(cudaMemsetAsync(block.lists[0].count, 0, kEngineLists * sizeof(std::uint32_t), stream));
    launch_engine(block, stream);
  }

  std::uint32_t left_to_host(const EngineBlock& block) {
    std::uint32_t count;
    check(cudaMemcpy(&count, block.undecided.count, sizeof count, cudaMemcpyDeviceToHost));
    return count;
  }

  EngineResult fetch(const EngineBlock& block) {
    std::uint32_t lengths[2];
    check(cudaMemcpy(lengths, block.undecided.count, sizeof lengths, cudaMemcpyDeviceToHost));
    if (lengths[0] > kMostUndecided)
      throw std::runtime_error("the engine left too many pairs to the host; run fewer at once");
    if (lengths[1]) throw std::runtime_error("the engine found more signatures than it can hold");
    EngineResult result;
    std::vector<std::uint64_t> counts(2 * counters() + 1);
    check(cudaMemcpy(counts.data(), block.counts, counts.size() * sizeof counts[0], cudaMemcpyDeviceToHost));
    const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counters());
    result.disagreements = counts.back();
    result.counts.assign(counts.begin(), middle);
    if (block.axis != Axis::none) result.extreme_counts.assign(middle, counts.end() - 1);
    result.undecided.resize(lengths[0]);
    check(cudaMemcpy(result.undecided.data(), block.undecided.indices, lengths[0] * sizeof result.undecided[0],
                     cudaMemcpyDeviceToHost));
    std::sort(result.undecided.begin(), result.undecided.end());
    result.signatures.resize(kSignatures);
    check(cudaMemcpy(result.signatures.data(), block.signatures.rows, kSignatures * sizeof result.signatures[0],
                     cudaMemcpyDeviceToHost));
    std::erase_if(result.signatures, [](const EngineSignature& row) { return row.bits == 0; });
    std::sort(result.signatures.begin(), result.signatures.end(),
              [](const EngineSignature& l, const EngineSignature& r) { return l.bits < r.bits; });
    return result;
  }

  std::size_t counters() const { return engine_counters(static_cast<int>(lanes_.size())); }

  int ordinal_;
  std::vector<const Lane*> lanes_;
  std::unique_ptr<Buffers> buffers_[kBlocksAtOnce];
  DeviceArray<std::uint32_t> lengths_;
  DeviceArray<std::uint64_t> undecided_;
  DeviceArray<unsigned long long> counts_;
  DeviceArray<EngineSignature> signatures_;
};

}  // namespace

std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const> cuda_lanes) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess) {
    cudaGetLastError();  // clears it
    devices = 0;
  }
  std::vector<std::unique_ptr<DeviceEngine>> engines;
  for (int ordinal = 0; ordinal < devices; ++ordinal)
    engines.push_back(std::make_unique<CudaEngine>(ordinal, cuda_lanes));
  return engines;
}

}  // namespace graze::cuda
