// SPDX-License-Identifier: Apache-2.0
// All pairs get their margin's bucket from certified bounds. Those that the bounds leave open, and those on which a
// lane is wrong, are gathered for the kernels that find their relation exactly. Then everything is counted, a warp at a
// time.
#include "cuda/engine_kernels.h"

#include "core/margin_quick.h"
#include "core/margin_tie.h"
#include "cuda/kernels.h"

namespace graze {
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

__global__ void __launch_bounds__(kThreads, 2) measure_margins(EngineBlock block) {
  __shared__ std::uint32_t gathered, first;
  if (threadIdx.x == 0) gathered = 0;
  __syncthreads();
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  float c[kCoordinates];
  std::uint32_t mine = ~0u;
  if (i < block.pairs.count) {
    for (std::uint32_t k = 0; k < kCoordinates; ++k)
      c[k] = block.pairs.coordinates[std::size_t{k} * block.pairs.stride + i];
    const Verdict verdict = bit(block.truth, i) ? Verdict::intersects : Verdict::disjoint;
    Bucket bucket;
    if (!quick_bucket(pair_of(c), verdict, bucket)) bucket = kUndecided;
    block.buckets[i] = bucket;
    if (bucket == kUndecided || bit(block.wrong, i)) mine = atomicAdd(&gathered, 1u);
  }
  __syncthreads();
  if (threadIdx.x == 0 && gathered) first = atomicAdd(block.left.count, gathered);
  __syncthreads();
  if (mine == ~0u) return;
  for (std::uint32_t k = 0; k < kCoordinates; ++k)
    block.left.coordinates[std::size_t{k} * block.left.stride + first + mine] = c[k];
  block.left.places[first + mine] = i;
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
    const unsigned long long old = atomicCAS(slot, 0ull, bits);
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

// The bucket by all means that there are on a device, or kUndecided.
__device__ Bucket bucket_of(const float* c, const Relation& r) {
  if (r.margin_sign == 0) return 0;
  const Pair pair = pair_of(c);
  const Verdict verdict = r.intersects ? Verdict::intersects : Verdict::disjoint;
  const MarginBounds bounds = margin_bounds(pair, verdict);
  const int ulp = log2_ulp(pair);
  Bucket bucket;
  if (bucket_from_bounds(bounds, verdict, ulp, bucket)) return bucket;
  const int upper = floor_log2(bounds.hi);
  return !r.intersects && are_apart_by(c, c + 9, bounds.direction, upper) ? make_bucket(1, upper - ulp) : kUndecided;
}

// The relation is known: completes the bucket, or leaves the pair to the host, and adds the signatures.
__device__ void settle(const EngineBlock& block, const float* c, std::uint32_t i, const Relation& r) {
  Bucket bucket = block.buckets[i];
  if (bucket == kUndecided) {
    bucket = bucket_of(c, r);
    block.buckets[i] = bucket;
    if (bucket == kUndecided) {
      const std::uint32_t n = atomicAdd(block.undecided.count, 1u);
      if (n < block.undecided.size) block.undecided.indices[n] = block.first + i;
      return;
    }
  }
  if (bit(block.wrong, i)) add_signatures(block, i, r, bucket);
}

__global__ void __launch_bounds__(kThreads) relate(EngineBlock block) {
  for (std::uint32_t at = blockIdx.x * kThreads + threadIdx.x; at < *block.left.count; at += gridDim.x * kThreads) {
    float c[kCoordinates];
    for (std::uint32_t k = 0; k < kCoordinates; ++k)
      c[k] = block.left.coordinates[std::size_t{k} * block.left.stride + at];
    Relation r;
    if (!numbers::relate_quickly(c, c + 9, r)) {
      const numbers::Grid grid = numbers::grid_of(c, c + 9);
      if (grid.bits <= 15) {
        r = by_axes(numbers::triangles<numbers::DoubleNumbers>(c, c + 9));
      } else if (grid.bits <= 30) {
        r = by_axes(numbers::triangles<numbers::NarrowNumbers>(c, c + 9, grid.exponent));
      } else if (grid.bits <= 40) {
        r = by_axes(numbers::triangles<numbers::IntNumbers>(c, c + 9, grid.exponent));
      } else {
        const std::uint32_t n = atomicAdd(block.left_wide.count, 1u);
        block.left_wide.places[n] = at;
        continue;
      }
    }
    settle(block, c, block.left.places[at], r);
  }
}

__global__ void __launch_bounds__(kThreads) relate_wide(EngineBlock block) {
  for (std::uint32_t n = blockIdx.x * kThreads + threadIdx.x; n < *block.left_wide.count; n += gridDim.x * kThreads) {
    const std::uint32_t at = block.left_wide.places[n];
    float c[kCoordinates];
    for (std::uint32_t k = 0; k < kCoordinates; ++k)
      c[k] = block.left.coordinates[std::size_t{k} * block.left.stride + at];
    settle(block, c, block.left.places[at], by_axes(numbers::triangles<numbers::WideNumbers>(c, c + 9)));
  }
}

// A warp a word: the first thread of each bucket counts all pairs of that bucket.
__global__ void __launch_bounds__(kThreads) tally(EngineBlock block) {
  extern __shared__ std::uint32_t counts[];
  const int counters = static_cast<int>(engine_counters(block.lanes.count));
  for (int i = static_cast<int>(threadIdx.x); i < counters; i += kThreads) counts[i] = 0;
  __syncthreads();
  std::uint32_t disagreements = 0;
  const std::uint32_t words = (block.pairs.count + 31) / 32, lane_of_warp = threadIdx.x % 32;
  for (std::uint32_t word = (blockIdx.x * kThreads + threadIdx.x) / 32; word < words;
       word += gridDim.x * kThreads / 32) {
    const std::uint32_t i = word * 32 + lane_of_warp;
    const std::int8_t bucket = i < block.pairs.count ? block.buckets[i] : kUndecided;
    const std::uint32_t known = __ballot_sync(0xffffffffu, bucket != kUndecided);
    const std::uint32_t same = __match_any_sync(0xffffffffu, bucket);
    disagreements += lane_of_warp == 0 ? __popc(block.wrong[word] & known) : 0;
    if (bucket == kUndecided || static_cast<unsigned>(__ffs(static_cast<int>(same)) - 1) != lane_of_warp) continue;
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
  if (disagreements) atomicAdd(block.disagreements, static_cast<unsigned long long>(disagreements));
  __syncthreads();
  for (int i = static_cast<int>(threadIdx.x); i < counters; i += kThreads) {
    if (counts[i]) atomicAdd(&block.counts[i], static_cast<unsigned long long>(counts[i]));
  }
}

constexpr unsigned kBlocks = 1024;

}  // namespace

void launch_engine(const EngineBlock& block, cudaStream_t stream) {
  const std::uint32_t n = block.pairs.count;
  mark_wrong<<<((n + 31) / 32 + kThreads - 1) / kThreads, kThreads, 0, stream>>>(block);
  measure_margins<<<(n + kThreads - 1) / kThreads, kThreads, 0, stream>>>(block);
  relate<<<kBlocks, kThreads, 0, stream>>>(block);
  relate_wide<<<kBlocks, kThreads, 0, stream>>>(block);
  const std::size_t shared = engine_counters(block.lanes.count) * sizeof(std::uint32_t);
  check(cudaFuncSetAttribute(tally, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(shared)));
  tally<<<kBlocks, kThreads, shared, stream>>>(block);
  check(cudaGetLastError());
}

}  // namespace graze
