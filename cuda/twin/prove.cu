// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/prove.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>

#include "core/lanes/verdicts.h"
#include "cuda/lanes/device.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/stratum_kernels.cuh"
#include "cuda/twin/twin.h"
#include "strata/pair_source.h"

namespace graze::cuda {
namespace {

constexpr std::uint32_t kBlockPairs = 1u << 23;  // pairs in one block: 604 MB of coordinates in float32

// The number of differences, and the indices of up to kExamples of them, in no particular order.
struct Differences {
  unsigned long long count;
  std::uint64_t places[kExamples];
};

__device__ void note(Differences* differences, std::uint64_t place) {
  const unsigned long long n = atomicAdd(&differences->count, 1ull);
  if (n < kExamples) differences->places[n] = place;
}

// Counts the differences between the first `count` bits of a and b. Bit i % 32 of word i / 32 is for index first + i.
__global__ void compare_bits(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t count, std::uint64_t first,
                             Differences* differences) {
  const std::uint32_t word = blockIdx.x * blockDim.x + threadIdx.x;
  if (word * 32 >= count) return;
  for (std::uint32_t differ = a[word] ^ b[word]; differ != 0; differ &= differ - 1) {
    const std::uint32_t place = word * 32 + static_cast<std::uint32_t>(__ffs(static_cast<int>(differ)) - 1);
    if (place < count) note(differences, first + place);
  }
}

__global__ void compare_hashes(const std::uint64_t* a, const std::uint64_t* b, std::uint32_t count, std::uint64_t first,
                               Differences* differences) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count && a[i] != b[i]) note(differences, first + i);
}

std::uint32_t blocks_for(std::uint32_t threads) { return (threads + kThreads - 1) / kThreads; }

// The explicit PTX, assembled by the driver for this device.
class ExplicitKernels {
 public:
  ExplicitKernels(Variant variant, bool wrong_rule) {
    const std::string ptx = explicit_ptx(variant, wrong_rule);
    check(cudaLibraryLoadData(&library_, ptx.c_str(), nullptr, nullptr, 0, nullptr, nullptr, 0));
  }
  ExplicitKernels(const ExplicitKernels&) = delete;
  ExplicitKernels& operator=(const ExplicitKernels&) = delete;
  ~ExplicitKernels() { cudaLibraryUnload(library_); }

  template <class... Argument>
  void launch(const char* symbol, std::uint32_t threads, Argument... arguments) {
    cudaKernel_t kernel;
    check(cudaLibraryGetKernel(&kernel, library_, symbol));
    void* pointers[] = {&arguments...};
    check(cudaLaunchKernel(reinterpret_cast<const void*>(kernel), dim3(blocks_for(threads)), dim3(kThreads), pointers,
                           0, nullptr));
  }

 private:
  cudaLibrary_t library_;
};

// The results of a lane on a block: [0] from the default build, [1] from the explicit PTX.
struct LaneRun {
  DeviceArray<std::uint32_t> intersects[2], declined[2];
  DeviceArray<std::uint64_t> hashes[2];
};

// Code that depends on the pairs' coordinate type.
struct OfFloats {
  using Real = float;
  using Block = DevicePairs;
  static constexpr PairTypes kTypes = PairTypes::f32;

  static const TwinFunctions<Pair>& twin(const Lane& lane) { return twin_row(lane); }
  static void launch(const Lane& lane, const Block& block, std::uint32_t* yes, std::uint32_t* no_answer,
                     std::uint64_t* hashes) {
    const auto a = static_cast<std::size_t>(lane.algorithm), s = static_cast<std::size_t>(lane.scalar);
    kernels_of(lane.variant).decide[a][s](block, yes, no_answer, nullptr);
    kernels_of(lane.variant).trace[a][s](block, hashes, nullptr);
  }
};

struct OfDoubles {
  using Real = double;
  using Block = DeviceDoubles;
  static constexpr PairTypes kTypes = PairTypes::f64;

  static const TwinFunctions<DoublePair>& twin(const Lane& lane) { return twin_row(lane).doubles; }
  static void launch(const Lane& lane, const Block& block, std::uint32_t* yes, std::uint32_t* no_answer,
                     std::uint64_t* hashes) {
    const auto a = static_cast<std::size_t>(lane.algorithm);
    kernels_of(lane.variant).decide_doubles[a](block, yes, no_answer, nullptr);
    kernels_of(lane.variant).trace_doubles[a](block, hashes, nullptr);
  }
};

template <class Coordinates>
class Prover {
  using Real = typename Coordinates::Real;
  using Block = typename Coordinates::Block;

 public:
  explicit Prover(const ProofOptions& options) : options_(options) {
    for (const Lane& lane : lanes()) {
      const auto& twin = Coordinates::twin(lane);
      if (!twin.decide || !matches_any(options.lanes, lane.id)) continue;
      lanes_.push_back(&lane);
      record_.lanes.push_back({lane.id, twin.hash, twin.trace_hash, {}});
      auto& module = explicit_[lane.variant];
      if (!module) module = std::make_unique<ExplicitKernels>(lane.variant, options.wrong_rule);
    }
  }

  ProofRecord run(const Device& device) {
    const auto start = std::chrono::steady_clock::now();
    record_.device = device.name;
    record_.driver = device.driver;
    record_.toolkit = device.toolkit;
    record_.seed = options_.seed;
    const std::vector<strata::PairSource> sources = of_strata(options_.pairs), samples = of_strata(options_.twin_pairs);
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const std::uint64_t pairs = sources[s].pairs, twin_pairs = std::min(pairs, samples[s].pairs);
      for (LaneProof& lane : record_.lanes) lane.strata.push_back({sources[s].id});
      for (std::uint64_t first = 0; first < pairs; first += kBlockPairs) {
        const auto n = static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlockPairs, pairs - first));
        const std::uint64_t sample = first < twin_pairs ? std::min<std::uint64_t>(n, twin_pairs - first) : 0;
        prove_block(sources[s], first, n, static_cast<std::uint32_t>(sample));
      }
      record_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (options_.progress) options_.progress(progress_line(sources[s].id));
    }
    return std::move(record_);
  }

 private:
  std::vector<strata::PairSource> of_strata(std::uint64_t pairs) const {
    return strata::stratum_sources(options_.seed, pairs, {}, Coordinates::kTypes);
  }

  std::string progress_line(const std::string& stratum) const {
    std::uint64_t differences = 0, twin_differences = 0;
    for (const LaneProof& lane : record_.lanes) {
      const StratumProof& row = lane.strata.back();
      differences += row.verdict_differences + row.trace_differences;
      twin_differences += row.twin_verdict_differences + row.twin_trace_differences;
    }
    return stratum + ": " + std::to_string(differences) + " differences on the device, " +
           std::to_string(twin_differences) + " from the twin, " + std::to_string(static_cast<int>(record_.seconds)) +
           " s";
  }

  void prove_block(const strata::PairSource& source, std::uint64_t first, std::uint32_t n, std::uint32_t sample) {
    Real* on_device = coordinates_.at_least(std::size_t{n} * kCoordinates);
    drawing_.draw(source, first, n, on_device, nullptr);
    const Block block{on_device, n, n};
    if (sample) fetch_pairs(n, sample);
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      StratumProof& row = record_.lanes[l].strata.back();
      run_lane(*lanes_[l], block);
      compare_on_device(row, first, n);
      if (sample) compare_with_twin(*lanes_[l], row, first, sample);
    }
  }

  void run_lane(const Lane& lane, const Block& block) {
    const std::size_t words = (block.count + kThreads - 1) / kThreads * (kThreads / 32);
    std::uint32_t *yes[2], *no_answer[2];
    std::uint64_t* hashes[2];
    for (int v = 0; v < 2; ++v) {
      yes[v] = run_.intersects[v].at_least(words);
      no_answer[v] = run_.declined[v].at_least(words);
      hashes[v] = run_.hashes[v].at_least(block.count);
    }
    Coordinates::launch(lane, block, yes[0], no_answer[0], hashes[0]);
    check(cudaGetLastError());
    const auto& twin = Coordinates::twin(lane);
    ExplicitKernels& kernels = *explicit_.at(lane.variant);
    kernels.launch(twin.symbol, block.count, block, yes[1], no_answer[1]);
    kernels.launch(twin.trace_symbol, block.count, block, hashes[1]);
  }

  void compare_on_device(StratumProof& row, std::uint64_t first, std::uint32_t n) {
    Differences* found = differences_.at_least(3);
    check(cudaMemset(found, 0, 3 * sizeof(Differences)));
    const std::uint32_t blocks_of_words = blocks_for((n + 31) / 32);
    compare_bits<<<blocks_of_words, kThreads>>>(run_.intersects[0].at_least(0), run_.intersects[1].at_least(0), n,
                                                first, found);
    compare_bits<<<blocks_of_words, kThreads>>>(run_.declined[0].at_least(0), run_.declined[1].at_least(0), n, first,
                                                found + 1);
    compare_hashes<<<blocks_for(n), kThreads>>>(run_.hashes[0].at_least(0), run_.hashes[1].at_least(0), n, first,
                                                found + 2);
    check(cudaGetLastError());
    Differences host[3];
    check(cudaMemcpy(host, found, sizeof host, cudaMemcpyDeviceToHost));
    row.pairs += n;
    row.verdict_differences += host[0].count + host[1].count;
    row.trace_differences += host[2].count;
    for (const Differences& d : host) {
      for (std::uint32_t e = 0; e < std::min<unsigned long long>(d.count, kExamples) && row.examples.size() < kExamples;
           ++e)
        row.examples.push_back(d.places[e]);
    }
  }

  // Copies the block's first pairs, which the kernels have decided, from the device.
  void fetch_pairs(std::uint32_t n, std::uint32_t sample) {
    std::vector<Real> column(sample);
    pairs_.resize(sample);
    for (int c = 0; c < kCoordinates; ++c) {
      check(cudaMemcpy(column.data(), coordinates_.at_least(0) + std::size_t{n} * static_cast<std::size_t>(c),
                       sample * sizeof(Real), cudaMemcpyDeviceToHost));
      for (std::uint32_t i = 0; i < sample; ++i) coordinates(pairs_[i])[c] = column[i];
    }
  }

  void compare_with_twin(const Lane& lane, StratumProof& row, std::uint64_t first, std::uint32_t sample) {
    const std::size_t words = (sample + 63) / 64;
    std::vector<std::uint64_t> yes(words), no_answer(words), hashes(sample);
    check(cudaMemcpy(yes.data(), run_.intersects[0].at_least(0), (sample + 31) / 32 * sizeof(std::uint32_t),
                     cudaMemcpyDeviceToHost));
    check(cudaMemcpy(no_answer.data(), run_.declined[0].at_least(0), (sample + 31) / 32 * sizeof(std::uint32_t),
                     cudaMemcpyDeviceToHost));
    check(
        cudaMemcpy(hashes.data(), run_.hashes[0].at_least(0), sample * sizeof(std::uint64_t), cudaMemcpyDeviceToHost));
    const auto& twin = Coordinates::twin(lane);

    constexpr std::size_t kPart = 1 << 14;
    std::atomic<std::uint64_t> verdicts = 0, traces = 0;
    std::vector<std::uint64_t> examples(kExamples);
    std::atomic<std::size_t> example_count = 0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sample, kPart), [&](const auto& part) {
      const std::size_t n = part.size(), at = part.begin();
      std::vector<std::uint64_t> twin_yes((n + 63) / 64), twin_no_answer(twin_yes.size()), twin_hashes(n);
      twin.decide(pairs_.data() + at, n, twin_yes.data(), twin_no_answer.data());
      twin.trace(pairs_.data() + at, n, twin_hashes.data());
      for (std::size_t i = 0; i < n; ++i) {
        const bool verdict = test_bit(twin_yes, i) != test_bit(yes, at + i) ||
                             test_bit(twin_no_answer, i) != test_bit(no_answer, at + i);
        const bool hash = twin_hashes[i] != hashes[at + i];
        verdicts += verdict;
        traces += hash;
        if (!verdict && !hash) continue;
        if (const std::size_t e = example_count++; e < kExamples) examples[e] = first + at + i;
      }
    });
    row.twin_pairs += sample;
    row.twin_verdict_differences += verdicts;
    row.twin_trace_differences += traces;
    for (std::size_t e = 0; e < std::min<std::size_t>(example_count, kExamples) && row.examples.size() < kExamples; ++e)
      row.examples.push_back(examples[e]);
  }

  const ProofOptions& options_;
  ProofRecord record_;
  std::vector<const Lane*> lanes_;
  std::map<Variant, std::unique_ptr<ExplicitKernels>> explicit_;
  LaneRun run_;
  Drawing drawing_;
  DeviceArray<Real> coordinates_;
  DeviceArray<Differences> differences_;
  std::vector<BasicPair<Real>> pairs_;
};

}  // namespace

ProofRecord prove_twin(const ProofOptions& options) {
  std::string why_not;
  const auto device = open_device(why_not);
  if (!device) throw std::runtime_error("a proof needs a device: " + why_not);
  return options.of_doubles ? Prover<OfDoubles>(options).run(*device) : Prover<OfFloats>(options).run(*device);
}

}  // namespace graze::cuda
