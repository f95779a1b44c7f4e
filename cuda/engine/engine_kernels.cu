// SPDX-License-Identifier: Apache-2.0
// Every pair gets its margin's bucket, from the cheapest bounds that decide it: each kernel lists what it leaves for
// the next, so that a warp does not wait for one hard pair in 32. Those on which a lane is wrong, and those whose
// margin may be zero, get their relation. Then everything is counted, a warp at a time.
#include "cuda/engine/engine_kernels.cuh"

#include "core/margin/single_precision.h"
#include "core/margin/tie_proof.h"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {
namespace {

using exact::Relation;
namespace numbers = exact::detail;

__device__ bool bit(const std::uint32_t* words, std::uint32_t i) { return words[i / 32] >> (i % 32) & 1; }

__global__ void mark_wrong(EngineBlock block) {
  const std::uint32_t word = blockIdx.x * blockDim.x + threadIdx.x;
  if (word * 32 >= block.pairs.count) return;
  std::uint32_t wrong = 0;
  for (int l = 0; l < block.lanes.count; ++l) {
    const LaneWords& lane = block.lanes.lane[l];
    wrong |= (lane.intersects[word] ^ block.truth[word]) | lane.declined[word];
  }
  block.wrong[word] = wrong;
}

__device__ Pair pair_of(const float* c) {
  return {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}},
          {{c[9], c[10], c[11]}, {c[12], c[13], c[14]}, {c[15], c[16], c[17]}}};
}

__device__ Verdict verdict_of(const EngineBlock& block, std::uint32_t i) {
  return bit(block.truth, i) ? Verdict::intersects : Verdict::disjoint;
}

// Calls visit(i, coordinates of pair i) for the listed pairs.
template <class Visit>
__device__ void for_listed(const EngineBlock& block, EngineList which, const Visit& visit) {
  const Places& list = block.lists[which];
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *list.count; n += gridDim.x * kThreads) {
    float c[kCoordinates];
    load(block.pairs, list.at[n], c);
    visit(list.at[n], c);
  }
}

// The threads of a block take its disjoint pairs first, then the others, so that the two ways do not share a warp.
__device__ std::uint32_t by_verdict(const EngineBlock& block, std::uint16_t* order) {
  const std::uint32_t word = threadIdx.x / 32, in_word = threadIdx.x % 32, first = blockIdx.x * (kThreads / 32);
  std::uint32_t meet = 0, before = 0;  // pairs that meet: of all, and of those before this thread's
  for (std::uint32_t w = 0; w < kThreads / 32; ++w) {
    const std::uint32_t truth = block.truth[first + w], earlier = w < word ? ~0u : w == word ? (1u << in_word) - 1 : 0;
    meet += static_cast<std::uint32_t>(__popc(truth));
    before += static_cast<std::uint32_t>(__popc(truth & earlier));
  }
  const bool meets = block.truth[first + word] >> in_word & 1;
  order[meets ? kThreads - meet + before : threadIdx.x - before] = static_cast<std::uint16_t>(threadIdx.x);
  __syncthreads();
  return blockIdx.x * kThreads + order[threadIdx.x];
}

__global__ void __launch_bounds__(kThreads, 2) measure_by_single(EngineBlock block) {
  __shared__ std::uint16_t order[kThreads];
  const std::uint32_t i = by_verdict(block, order);
  if (i >= block.pairs.count) return;
  float c[kCoordinates];
  load(block.pairs, i, c);
  Bucket bucket;
  const Verdict verdict = verdict_of(block, i);
  if (!bucket_by_single(pair_of(c), verdict, bucket)) {
    bucket = kUndecided;
    block.lists[verdict == Verdict::intersects ? kOpenDepths : kOpenGaps].add(i);
  }
  block.buckets[i] = bucket;
  if (bit(block.wrong, i)) block.lists[kRelated].add(i);
}

template <Verdict verdict>
__global__ void __launch_bounds__(kThreads, 2) measure_by_double(EngineBlock block) {
  for_listed(block, verdict == Verdict::disjoint ? kOpenGaps : kOpenDepths, [&](std::uint32_t i, const float* c) {
    Bucket bucket;
    if (bucket_by_double(pair_of(c), verdict, bucket)) {
      block.buckets[i] = bucket;
    } else if (verdict == Verdict::disjoint) {
      block.lists[kTies].add(i);
    } else if (!bit(block.wrong, i)) {
      block.lists[kRelated].add(i);
    }
  });
}

__device__ void leave_to_host(const EngineBlock& block, std::uint32_t i) {
  const std::uint32_t n = atomicAdd(block.undecided.count, 1u);
  if (n < block.undecided.size) block.undecided.indices[n] = block.first + i;
}

// The bucket by all means that there are on a device, or kUndecided.
__device__ Bucket bucket_by_all_means(const float* c, Verdict verdict) {
  const Pair pair = pair_of(c);
  const MarginBounds bounds = margin_bounds(pair, verdict);
  const int ulp = log2_ulp(pair);
  Bucket bucket;
  if (bucket_from_bounds(bounds, verdict, ulp, bucket)) return bucket;
  const int upper = floor_log2(bounds.hi);
  const bool proven = verdict == Verdict::disjoint && are_apart_by(c, c + 9, bounds.direction, upper);
  return proven ? make_bucket(1, upper - ulp) : kUndecided;
}

__global__ void __launch_bounds__(kThreads) break_ties(EngineBlock block) {
  for_listed(block, kTies, [&](std::uint32_t i, const float* c) {
    block.buckets[i] = bucket_by_all_means(c, Verdict::disjoint);
    if (block.buckets[i] == kUndecided) leave_to_host(block, i);
  });
}

// 1: right; 2: false positive; 3: false negative; 4: declined.
__device__ SignatureBits mark_of(const LaneWords& lane, std::uint32_t i, bool truth) {
  if (bit(lane.declined, i)) return 4;
  const bool says = bit(lane.intersects, i);
  return says == truth ? 1 : says ? 2 : 3;
}

__device__ void keep(EngineSignature& row, std::uint64_t index) {
  unsigned long long* cases = reinterpret_cast<unsigned long long*>(row.cases);
  unsigned long long v = index;
  if (v >= *const_cast<volatile unsigned long long*>(&cases[kEngineCases - 1])) return;
  // Whoever is larger moves on, so that in the end the smallest stand here in order, whoever came first.
  for (int k = 0; k < kEngineCases; ++k) {
    const unsigned long long old = atomicMin(&cases[k], v);
    v = old > v ? old : v;
  }
}

__device__ void add(const SignatureTable& table, SignatureBits bits, std::uint64_t index) {
  const unsigned same = __match_any_sync(__activemask(), bits);
  std::uint32_t at = static_cast<std::uint32_t>(bits * 0x9e3779b97f4a7c15u >> 32) & (table.size - 1);
  for (std::uint32_t tried = 0; tried < table.size; ++tried, at = (at + 1) & (table.size - 1)) {
    auto* slot = reinterpret_cast<unsigned long long*>(&table.rows[at].bits);
    unsigned long long old = *const_cast<volatile unsigned long long*>(slot);
    if (old == 0) old = atomicCAS(slot, 0ull, bits);
    if (old != 0 && old != bits) continue;
    if (static_cast<unsigned>(__ffs(static_cast<int>(same)) - 1) == threadIdx.x % 32)
      atomicAdd(reinterpret_cast<unsigned long long*>(&table.rows[at].count),
                static_cast<unsigned long long>(__popc(same)));
    keep(table.rows[at], index);
    return;
  }
  *table.full = 1;
}

__device__ void add_signatures(const EngineBlock& block, std::uint32_t i, const Relation& r, std::int8_t bucket) {
  const SignatureBits shape =
      static_cast<SignatureBits>(bucket + kBucketMost) << 24 | static_cast<SignatureBits>(r.dimension_a) << 32 |
      static_cast<SignatureBits>(r.dimension_b) << 34 | static_cast<SignatureBits>(r.coplanar) << 36 |
      static_cast<SignatureBits>(r.contact + 1) << 37;
  for (int l = 0; l < block.lanes.count;) {
    const int algorithm = block.lanes.lane[l].algorithm;
    SignatureBits marks = 0;
    bool wrong = false;
    for (; l < block.lanes.count && block.lanes.lane[l].algorithm == algorithm; ++l) {
      const LaneWords& lane = block.lanes.lane[l];
      if (lane.slot < 0) continue;
      const SignatureBits mark = mark_of(lane, i, r.intersects);
      wrong = wrong || mark != 1;
      marks |= mark << 3 * lane.slot;
    }
    if (wrong) add(block.signatures, marks | shape | static_cast<SignatureBits>(algorithm + 1) << 39, block.first + i);
  }
}

// The relation is known: completes the bucket, or leaves that to the next kernel, and adds the signatures.
__device__ void settle(const EngineBlock& block, std::uint32_t i, const Relation& r) {
  Bucket bucket = block.buckets[i];
  if (bucket == kUndecided) {
    if (!r.intersects) return;  // the host has it
    if (r.margin_sign != 0) return block.lists[kDepths].add(i);
    block.buckets[i] = bucket = 0;
  }
  if (bit(block.wrong, i)) add_signatures(block, i, r, bucket);
}

__global__ void __launch_bounds__(kThreads, 2) relate(EngineBlock block) {
  for_listed(block, kRelated, [&](std::uint32_t i, const float* c) {
    Relation r;
    if (numbers::relate_quickly(c, c + 9, r)) return settle(block, i, r);
    block.lists[kByDoubles + numbers::AllNumbers::place(numbers::grid_of(c, c + 9))].add(i);
  });
}

template <class Numbers, EngineList list>
__global__ void __launch_bounds__(kThreads) relate_by_axes(EngineBlock block) {
  for_listed(block, list, [&](std::uint32_t i, const float* c) {
    const int exponent = numbers::grid_of(c, c + 9).exponent;
    settle(block, i, by_axes(numbers::triangles<Numbers>(c, c + 9, exponent)));
  });
}

__global__ void __launch_bounds__(kThreads) settle_depths(EngineBlock block) {
  for_listed(block, kDepths, [&](std::uint32_t i, const float* c) {
    const Bucket bucket = bucket_by_all_means(c, Verdict::intersects);
    block.buckets[i] = bucket;
    if (bucket == kUndecided) return leave_to_host(block, i);
    if (bit(block.wrong, i)) add_signatures(block, i, exact::relation(c, c + 9), bucket);
  });
}

// The extremes of the pairs whose bucket is known.
__global__ void __launch_bounds__(kThreads) place_extremes(EngineBlock block) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  if (i >= block.pairs.count) return;
  float c[kCoordinates];
  load(block.pairs, i, c);
  block.extremes[i] = block.buckets[i] == kUndecided ? kUndecided : place_on_axis(pair_of(c), block.axis);
}

// By bucket, or by extreme. A warp a word: the first thread of each bucket counts all pairs of that bucket.
__global__ void __launch_bounds__(kThreads) tally(EngineBlock block, bool by_extreme) {
  const std::int8_t* const buckets = by_extreme ? block.extremes : block.buckets;
  unsigned long long* const into = by_extreme ? block.extreme_counts : block.counts;
  extern __shared__ std::uint32_t counts[];
  const int counters = static_cast<int>(engine_counters(block.lanes.count));
  for (int i = static_cast<int>(threadIdx.x); i < counters; i += kThreads) counts[i] = 0;
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
    const std::uint32_t truth = block.truth[word];
    std::uint32_t* row = counts + (bucket + kBucketMost);
    const auto count = [&](int counter, std::uint32_t pairs) {
      if (pairs & same) atomicAdd(&row[counter * kBucketCount], static_cast<std::uint32_t>(__popc(pairs & same)));
    };
    count(0, same);
    count(1, truth);
    for (int l = 0; l < block.lanes.count; ++l) {
      const std::uint32_t yes = block.lanes.lane[l].intersects[word], none = block.lanes.lane[l].declined[word];
      count(2 + 4 * l, yes & ~truth & ~none);
      count(3 + 4 * l, ~yes & truth & ~none);
      count(4 + 4 * l, none);
    }
  }
  if (disagreements && !by_extreme) atomicAdd(block.disagreements, static_cast<unsigned long long>(disagreements));
  __syncthreads();
  for (int i = static_cast<int>(threadIdx.x); i < counters; i += kThreads) {
    if (counts[i]) atomicAdd(&into[i], static_cast<unsigned long long>(counts[i]));
  }
}

constexpr unsigned kBlocks = 1024;

}  // namespace

void launch_engine(const EngineBlock& block, cudaStream_t stream) {
  const std::uint32_t n = block.pairs.count;
  mark_wrong<<<((n + 31) / 32 + kThreads - 1) / kThreads, kThreads, 0, stream>>>(block);
  measure_by_single<<<(n + kThreads - 1) / kThreads, kThreads, 0, stream>>>(block);
  measure_by_double<Verdict::disjoint><<<kBlocks, kThreads, 0, stream>>>(block);
  measure_by_double<Verdict::intersects><<<kBlocks, kThreads, 0, stream>>>(block);
  break_ties<<<kBlocks, kThreads, 0, stream>>>(block);
  relate<<<kBlocks, kThreads, 0, stream>>>(block);
  relate_by_axes<numbers::DoubleNumbers, kByDoubles><<<kBlocks, kThreads, 0, stream>>>(block);
  relate_by_axes<numbers::NarrowNumbers, kByNarrow><<<kBlocks, kThreads, 0, stream>>>(block);
  relate_by_axes<numbers::IntNumbers, kByInts><<<kBlocks, kThreads, 0, stream>>>(block);
  relate_by_axes<numbers::LongNumbers, kByLong><<<kBlocks, kThreads, 0, stream>>>(block);
  relate_by_axes<numbers::WideNumbers, kByWide><<<kBlocks, kThreads, 0, stream>>>(block);
  settle_depths<<<kBlocks, kThreads, 0, stream>>>(block);
  const std::size_t shared = engine_counters(block.lanes.count) * sizeof(std::uint32_t);
  check(cudaFuncSetAttribute(tally, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(shared)));
  tally<<<kBlocks, kThreads, shared, stream>>>(block, false);
  if (block.axis != Axis::none) {
    place_extremes<<<(n + kThreads - 1) / kThreads, kThreads, 0, stream>>>(block);
    tally<<<kBlocks, kThreads, shared, stream>>>(block, true);
  }
  check(cudaGetLastError());
}

}  // namespace graze::cuda
