// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine.h"

#include <algorithm>

#include "cuda/engine_kernels.h"
#include "cuda/kernels.h"
#include "cuda/prove_kernels.h"

namespace graze {
namespace {

constexpr std::uint32_t kBlockPairs = 1u << 22;  // decided together; a multiple of kThreads
constexpr std::uint32_t kSignatures = 1u << 18;  // a million pairs of all strata make six thousand
constexpr std::uint32_t kMostUndecided = 1u << 26;
constexpr int kBlocksBetweenLooks = 8;

class CudaEngine final : public Engine {
 public:
  CudaEngine(int ordinal, std::span<const Lane* const> lanes) : ordinal_(ordinal), lanes_(lanes.begin(), lanes.end()) {
    if (lanes.size() > kMostLanes) throw std::runtime_error("the engine takes 32 lanes at most");
  }

  EngineResult run(std::uint64_t seed, int stratum, std::uint64_t first, std::uint64_t count) override {
    check(cudaSetDevice(ordinal_));
    check(cudaSetDeviceFlags(cudaDeviceLmemResizeToMax));  // else each kernel with a stack of its own size waits for it
    EngineBlock block = begin();
    std::uint64_t done = 0;
    for (int b = 1; done < count; ++b) {
      block.pairs.count = static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlockPairs, count - done));
      block.pairs.stride = block.pairs.count;
      block.first = first + done;
      judge(block, seed, stratum);
      done += block.pairs.count;
      if (b % kBlocksBetweenLooks == 0 && left_to_host(block) > kMostUndecided - kBlocksBetweenLooks * kBlockPairs)
        break;
    }
    EngineResult result = fetch(block);
    result.done = done;
    return result;
  }

 private:
  // Empties what adds up over the blocks.
  EngineBlock begin() {
    EngineBlock block{};
    block.pairs.coordinates = coordinates_.at_least(std::size_t{kBlockPairs} * kCoordinates);
    block.truth = truth_.at_least(kWords);
    block.wrong = wrong_.at_least(kWords);
    block.buckets = buckets_.at_least(kBlockPairs);
    block.lanes.count = static_cast<int>(lanes_.size());
    std::uint32_t* words = lane_words_.at_least(2 * kWords * lanes_.size());
    std::uint32_t* none = none_.at_least(kWords);
    check(cudaMemset(none, 0, kWords * sizeof *none));
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      const Lane& lane = *lanes_[l];
      if (lane.is_exact()) {  // it is the truth, and declines nothing
        block.lanes.lane[l] = {block.truth, none, lane.algorithm, -1};
        continue;
      }
      const int slot = static_cast<int>(lane.scalar) * kTargetCount + static_cast<int>(lane.target);
      block.lanes.lane[l] = {words + 2 * kWords * l, words + 2 * kWords * l + kWords, lane.algorithm, slot};
    }
    std::uint32_t* lengths = lengths_.at_least(4);
    block.left = {left_.at_least(std::size_t{kBlockPairs} * kCoordinates), kBlockPairs, places_.at_least(kBlockPairs),
                  lengths};
    block.left_wide = {nullptr, 0, wide_places_.at_least(kBlockPairs), lengths + 1};
    block.undecided = {undecided_.at_least(kMostUndecided), kMostUndecided, lengths + 2};
    block.signatures = {signatures_.at_least(kSignatures), kSignatures, lengths + 3};
    block.counts = counts_.at_least(counters() + 1);
    block.disagreements = block.counts + counters();
    check(cudaMemset(lengths, 0, 4 * sizeof *lengths));
    check(cudaMemset(block.counts, 0, (counters() + 1) * sizeof *block.counts));
    std::vector<EngineSignature> empty(kSignatures);
    for (EngineSignature& row : empty) std::fill_n(row.cases, kEngineCases, ~std::uint64_t{0});
    check(cudaMemcpy(block.signatures.rows, empty.data(), empty.size() * sizeof empty[0], cudaMemcpyHostToDevice));
    return block;
  }

  void judge(const EngineBlock& block, std::uint64_t seed, int stratum) {
    launch_generate(coordinates_.at_least(0), block.pairs.count, seed, stratum, block.first, nullptr);
    std::uint32_t* truth = truth_.at_least(0);
    // No stratum has pairs that are not finite: nothing is declined, and `wrong` is free until it is written.
    exact_.decide(block.pairs, truth, block.wrong, nullptr, nullptr);
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      const LaneWords& words = block.lanes.lane[l];
      if (words.intersects == truth) continue;
      launch_lane(*lanes_[l], exact_, block.pairs, const_cast<std::uint32_t*>(words.intersects),
                  const_cast<std::uint32_t*>(words.declined), nullptr);
    }
    check(cudaMemsetAsync(block.left.count, 0, 2 * sizeof(std::uint32_t), nullptr));
    launch_engine(block, nullptr);
  }

  std::uint32_t left_to_host(const EngineBlock& block) {
    std::uint32_t count;
    check(cudaMemcpy(&count, block.undecided.count, sizeof count, cudaMemcpyDeviceToHost));
    return count;
  }

  EngineResult fetch(const EngineBlock& block) {
    std::uint32_t lengths[4];
    check(cudaMemcpy(lengths, block.left.count, sizeof lengths, cudaMemcpyDeviceToHost));
    if (lengths[2] > kMostUndecided)
      throw std::runtime_error("the engine left too many pairs to the host; run fewer at once");
    if (lengths[3]) throw std::runtime_error("the engine found more signatures than it can hold");
    EngineResult result;
    result.counts.resize(counters() + 1);
    check(cudaMemcpy(result.counts.data(), block.counts, result.counts.size() * sizeof result.counts[0],
                     cudaMemcpyDeviceToHost));
    result.disagreements = result.counts.back();
    result.counts.pop_back();
    result.undecided.resize(lengths[2]);
    check(cudaMemcpy(result.undecided.data(), block.undecided.indices, lengths[2] * sizeof result.undecided[0],
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

  static constexpr std::size_t kWords = kBlockPairs / 32;

  int ordinal_;
  std::vector<const Lane*> lanes_;
  DeviceExact exact_;
  DeviceArray<float> coordinates_, left_;
  DeviceArray<std::uint32_t> truth_, wrong_, none_, lane_words_, places_, wide_places_, lengths_;
  DeviceArray<std::int8_t> buckets_;
  DeviceArray<std::uint64_t> undecided_;
  DeviceArray<unsigned long long> counts_;
  DeviceArray<EngineSignature> signatures_;
};

}  // namespace

std::vector<std::unique_ptr<Engine>> open_engines(std::span<const Lane* const> cuda_lanes) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess) {
    cudaGetLastError();  // clears it
    devices = 0;
  }
  std::vector<std::unique_ptr<Engine>> engines;
  for (int ordinal = 0; ordinal < devices; ++ordinal)
    engines.push_back(std::make_unique<CudaEngine>(ordinal, cuda_lanes));
  return engines;
}

}  // namespace graze
