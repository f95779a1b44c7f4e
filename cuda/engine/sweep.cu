// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/sweep.h"

#include <algorithm>

#include "core/judged_bits.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/stratum_kernels.cuh"

namespace graze::cuda {
namespace {

constexpr std::uint32_t kPairsAtOnce = 1u << 22;
constexpr std::uint32_t kWords = kPairsAtOnce / 32;

// A lane's verdicts: bit i % 32 of word i / 32 belongs to pair i.
struct Bits {
  std::uint32_t *intersects, *declined;
};

__device__ void add(std::uint64_t* to, std::uint32_t count) {
  for (int from = 16; from > 0; from /= 2) count += __shfl_down_sync(0xffffffffu, count, from);
  if (threadIdx.x % 32 == 0 && count) atomicAdd(reinterpret_cast<unsigned long long*>(to), count);
}

__device__ void add(std::uint64_t* to, std::uint64_t* least, std::uint32_t bits, std::uint64_t first_of_word) {
  add(to, static_cast<std::uint32_t>(__popc(bits)));
  if (bits) {
    const auto index = first_of_word + static_cast<std::uint64_t>(__ffs(static_cast<int>(bits)) - 1);
    if (index < *const_cast<volatile std::uint64_t*>(least))
      atomicMin(reinterpret_cast<unsigned long long*>(least), index);
  }
}

// Each thread counts the errors in one word of verdicts.
__global__ void __launch_bounds__(kThreads)
    add_errors(Bits truth, Bits zero, Bits lane, std::uint32_t pairs, std::uint64_t first, ErrorCounts* counts) {
  const std::uint32_t w = blockIdx.x * kThreads + threadIdx.x;
  JudgedBits<std::uint32_t> now{}, before{};
  if (w * 32 < pairs) {
    const std::uint32_t in_range = pairs - w * 32 >= 32 ? ~0u : (1u << (pairs - w * 32)) - 1;
    const std::uint32_t judged = in_range & ~truth.declined[w];  // pairs that are not finite are not counted
    now = judge(lane.intersects[w], lane.declined[w], truth.intersects[w], judged);
    before = judge(zero.intersects[w], zero.declined[w], truth.intersects[w], judged);
  }
  add(&counts->false_positive, static_cast<std::uint32_t>(__popc(now.false_positive)));
  add(&counts->false_negative, static_cast<std::uint32_t>(__popc(now.false_negative)));
  add(&counts->declined, static_cast<std::uint32_t>(__popc(now.declined)));
  const std::uint64_t index = first + std::uint64_t{w} * 32;
  add(&counts->fixed, &counts->first_fixed, before.not_right() & ~now.not_right(), index);
  add(&counts->broken, &counts->first_broken, now.not_right() & ~before.not_right(), index);
}

}  // namespace

std::vector<ErrorCounts> count_errors(const Lane& zero, std::span<const Lane> lanes, const strata::PairSource& source) {
  check(cudaSetDevice(0));
  std::vector<ErrorCounts> counts(lanes.size());
  DeviceArray<ErrorCounts> on_device;
  DeviceArray<float> coordinates;
  DeviceArray<double> coordinates_in_double;
  DeviceArray<std::uint32_t> words;
  DeviceExact exact;
  Drawing drawing;
  ErrorCounts* totals = on_device.at_least(lanes.size());
  check(cudaMemcpy(totals, counts.data(), counts.size() * sizeof *totals, cudaMemcpyHostToDevice));
  const std::size_t numbers = std::size_t{kPairsAtOnce} * kCoordinates;
  float* block = coordinates.at_least(numbers);
  double* in_doubles = source.in_doubles() ? coordinates_in_double.at_least(numbers) : nullptr;
  std::uint32_t* word = words.at_least(6 * kWords);
  const Bits truth{word, word + kWords}, without{word + 2 * kWords, word + 3 * kWords},
      under{word + 4 * kWords, word + 5 * kWords};
  for (std::uint64_t first = 0; first < source.pairs; first += kPairsAtOnce) {
    const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(kPairsAtOnce, source.pairs - first));
    const DevicePairs pairs{block, count, count};
    const DeviceDoubles doubles{in_doubles, count, count};
    if (in_doubles) {
      drawing.draw(source, first, count, in_doubles, nullptr, block);
      exact.decide(doubles, truth.intersects, truth.declined, nullptr, nullptr);
    } else {
      drawing.draw(source, first, count, block, nullptr);
      exact.decide(pairs, truth.intersects, truth.declined, nullptr, nullptr);
    }
    const auto decide = [&](const Lane& lane, const Bits& to) {
      if (in_doubles && lane.scalar == Scalar::f64) {
        launch_lane(lane, exact, doubles, to.intersects, to.declined, nullptr);
      } else {
        launch_lane(lane, exact, pairs, to.intersects, to.declined, nullptr);
      }
    };
    decide(zero, without);
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      decide(lanes[l], under);
      add_errors<<<(count / 32 + kThreads) / kThreads, kThreads>>>(truth, without, under, count, first, totals + l);
    }
    check(cudaGetLastError());
  }
  check(cudaMemcpy(counts.data(), totals, counts.size() * sizeof *totals, cudaMemcpyDeviceToHost));
  return counts;
}

}  // namespace graze::cuda
