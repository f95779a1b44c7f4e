// SPDX-License-Identifier: Apache-2.0
// The steps of cuda/engine/engine_steps.h as kernels with one thread per pair. The tally has one warp per word.
#include "cuda/engine/engine_kernels.cuh"

#include "cuda/engine/engine_steps.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {
namespace {

template <class Step, class Block>
__global__ void __launch_bounds__(kThreads) for_words(Block block) {
  const std::uint32_t word = blockIdx.x * kThreads + threadIdx.x;
  if (word * 32 < block.pairs.count) Step()(block, word);
}

template <class Step, class Block>
__device__ void take(const Block& block, std::uint32_t i) {
  if (i >= block.pairs.count) return;
  float c[kCoordinates];
  load(block.pairs, i, c);
  Step()(block, i, c);
}

template <class Step, class Block>
__global__ void __launch_bounds__(kThreads, Step::kThreadBlocks) for_pairs(Block block) {
  take<Step>(block, blockIdx.x * kThreads + threadIdx.x);
}

// A block's first threads take its disjoint pairs, the other threads the intersecting ones, so few warps diverge.
template <class Step, class Block>
__global__ void __launch_bounds__(kThreads, Step::kThreadBlocks) for_pairs_by_verdict(Block block) {
  __shared__ std::uint16_t order[kThreads];
  const std::uint32_t word = threadIdx.x / 32, in_word = threadIdx.x % 32, first = blockIdx.x * (kThreads / 32);
  std::uint32_t meet = 0, before = 0;  // intersecting pairs: all, and those before this thread's pair
  for (std::uint32_t w = 0; w < kThreads / 32; ++w) {
    const std::uint32_t truth = block.truth[first + w], earlier = w < word ? ~0u : w == word ? (1u << in_word) - 1 : 0;
    meet += static_cast<std::uint32_t>(__popc(truth));
    before += static_cast<std::uint32_t>(__popc(truth & earlier));
  }
  const bool meets = block.truth[first + word] >> in_word & 1;
  order[meets ? kThreads - meet + before : threadIdx.x - before] = static_cast<std::uint16_t>(threadIdx.x);
  __syncthreads();
  take<Step>(block, blockIdx.x * kThreads + order[threadIdx.x]);
}

template <class Step, class Block>
__global__ void __launch_bounds__(kThreads, Step::kThreadBlocks) for_listed(Block block, EngineList which) {
  const PairList& list = block.lists[which];
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *list.count; n += gridDim.x * kThreads) {
    float c[kCoordinates];
    load(block.pairs, list.at[n], c);
    Step()(block, list.at[n], c);
  }
}

// Counts one pair for each thread in the mask; all these threads must call it. One thread counts all pairs with the
// same key.
__device__ void add_together(const SignatureTable& table, const SignatureKey& key, std::uint64_t index, unsigned mask) {
  const unsigned like = __match_any_sync(mask, hash_of(key, table.key_words));
  const int first = __ffs(static_cast<int>(like)) - 1;
  bool same = true;
  for (std::uint32_t k = 0; k < table.key_words; ++k) {
    const std::uint64_t word = key.word(k);
    same = __shfl_sync(like, word, first) == word && same;
  }
  const auto count = static_cast<std::uint64_t>(__popc(__ballot_sync(like, same)));
  std::uint64_t* row = nullptr;
  if (static_cast<int>(threadIdx.x % 32) == first) {
    row = find_row(table, key);
    if (row) add(table.count(row), count);
    if (!row) *table.full = 1;
  }
  row = reinterpret_cast<std::uint64_t*>(__shfl_sync(like, reinterpret_cast<unsigned long long>(row), first));
  if (!same) return add_pair(table, key, index);  // two keys with the same hash
  if (row) keep(table, row, index);
}

__global__ void __launch_bounds__(kThreads) add_signatures(EngineBlock block, EngineList which) {
  const PairList& list = block.lists[which];
  for (std::uint32_t begin = blockIdx.x * kThreads; begin < *list.count; begin += gridDim.x * kThreads) {
    const std::uint32_t n = begin + threadIdx.x;
    std::uint32_t i = n < *list.count ? list.at[n] : 0;
    const bool has_some = n < *list.count && has_signatures(block, i);
    const unsigned threads = __ballot_sync(0xffffffffu, has_some);
    if (threads == 0) continue;
    const std::uint32_t some = __shfl_sync(0xffffffffu, i, __ffs(static_cast<int>(threads)) - 1);
    if (!has_some) i = some;  // reads the key of some pair with signatures, but does not add it
    for (std::uint32_t g = 0; g < block.lanes.group_count; ++g) {
      const SignatureKey key(block, g, i);
      const bool adds = has_some && key.any_wrong();
      const unsigned mask = __ballot_sync(0xffffffffu, adds);
      if (adds) add_together(block.signatures, key, block.first + i, mask);
      __syncwarp();
    }
  }
}

constexpr unsigned kBlocks = 1024;
constexpr std::size_t kSharedBytes = 48 << 10;  // shared memory that a thread block has on every device
template <class Block>
constexpr std::uint32_t kLanesAtOnce =
    (kSharedBytes / sizeof(std::uint32_t) / kBucketCount - kCountersOfPairs) / Block::kCountersOfLane;

// Counts pairs by bucket or by extreme. One warp counts a word: the first thread whose pair is in a bucket counts all
// pairs in that bucket. Thread blocks with the same y count the same lanes, as many as shared memory has counters for.
template <class Block>
__global__ void __launch_bounds__(kThreads) tally(Block block, bool by_extreme) {
  extern __shared__ std::uint32_t counts[];
  const std::int8_t* const buckets = by_extreme ? block.extremes : block.buckets;
  const std::uint32_t from = block.lanes.count * blockIdx.y / gridDim.y;
  const std::uint32_t to = block.lanes.count * (blockIdx.y + 1) / gridDim.y;
  const auto counters = static_cast<std::uint32_t>(engine_counters<Block>(to - from));
  for (std::uint32_t k = threadIdx.x; k < counters; k += kThreads) counts[k] = 0;
  __syncthreads();
  std::uint32_t disagreements = 0;
  const std::uint32_t words = (block.pairs.count + 31) / 32, thread_of_warp = threadIdx.x % 32;
  for (std::uint32_t word = (blockIdx.x * kThreads + threadIdx.x) / 32; word < words;
       word += gridDim.x * kThreads / 32) {
    const std::uint32_t i = word * 32 + thread_of_warp;
    const std::int8_t bucket = i < block.pairs.count ? buckets[i] : kUndecided;
    const std::uint32_t known = __ballot_sync(0xffffffffu, bucket != kUndecided);
    const std::uint32_t same = __match_any_sync(0xffffffffu, bucket);
    disagreements += thread_of_warp == 0 ? __popc(block.wrong[word] & known) : 0;
    if (bucket == kUndecided || static_cast<unsigned>(__ffs(static_cast<int>(same)) - 1) != thread_of_warp) continue;
    std::uint32_t* row = counts + (bucket + kBucketMost);
    count_word(block, word, same, from, to, [&](std::uint32_t counter, std::uint32_t pairs) {
      if (pairs) atomicAdd(&row[counter * kBucketCount], static_cast<std::uint32_t>(__popc(pairs)));
    });
  }
  const bool first_chunk = blockIdx.y == 0;  // also counts the pairs
  if (disagreements && first_chunk && !by_extreme) add(block.disagreements, disagreements);
  __syncthreads();
  std::uint64_t* const into = by_extreme ? block.extreme_counts : block.counts;
  for (std::uint32_t k = threadIdx.x; k < counters; k += kThreads) {
    const bool of_pairs = k < kCountersOfPairs * kBucketCount;
    if (counts[k] && (first_chunk || !of_pairs))
      add(&into[k + (of_pairs ? 0 : from * Block::kCountersOfLane * kBucketCount)], counts[k]);
  }
}

template <class Block>
struct DeviceRun {
  const Block& block;
  cudaStream_t stream;

  static std::uint32_t thread_blocks(std::uint32_t threads) { return (threads + kThreads - 1) / kThreads; }

  template <class Step>
  void words(Step) const {
    for_words<Step, Block><<<thread_blocks((block.pairs.count + 31) / 32), kThreads, 0, stream>>>(block);
  }
  template <class Step>
  void pairs(Step) const {
    for_pairs<Step, Block><<<thread_blocks(block.pairs.count), kThreads, 0, stream>>>(block);
  }
  template <class Step>
  void pairs_by_verdict(Step) const {
    for_pairs_by_verdict<Step, Block><<<thread_blocks(block.pairs.count), kThreads, 0, stream>>>(block);
  }
  template <class Step>
  void listed(Step, EngineList list) const {
    for_listed<Step, Block><<<kBlocks, kThreads, 0, stream>>>(block, list);
  }
  void add_signatures(EngineList list) const { cuda::add_signatures<<<kBlocks, kThreads, 0, stream>>>(block, list); }
  void tally(bool by_extreme) const {
    const std::uint32_t chunks = (block.lanes.count + kLanesAtOnce<Block> - 1) / kLanesAtOnce<Block>;
    const std::size_t shared =
        engine_counters<Block>((block.lanes.count + chunks - 1) / chunks) * sizeof(std::uint32_t);
    cuda::tally<<<dim3(kBlocks, chunks), kThreads, shared, stream>>>(block, by_extreme);
  }
};

}  // namespace

void launch_engine(const EngineBlock& block, cudaStream_t stream) {
  run_steps(block, DeviceRun<EngineBlock>{block, stream});
  check(cudaGetLastError());
}

void launch_engine(const DoubleEngineBlock& block, cudaStream_t stream) {
  run_steps(block, DeviceRun<DoubleEngineBlock>{block, stream});
  check(cudaGetLastError());
}

}  // namespace graze::cuda
