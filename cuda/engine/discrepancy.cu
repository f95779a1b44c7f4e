// SPDX-License-Identifier: Apache-2.0
// This file is compiled without contraction; otherwise its counts would differ from the host's.
#include "cuda/engine/discrepancy.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <vector>

#include "core/discrepancy/count.h"
#include "core/discrepancy/questions.h"
#include "core/fnv1a.h"
#include "core/lanes/records.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/stratum_kernels.cuh"
#include "cuda/lanes/vote.cuh"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace {

constexpr std::uint32_t kPairsAtOnce = 1u << 20;

// The counters in device memory. If several threads of a warp add to one counter, one atomic operation adds their sum.
struct DeviceSink {
  std::uint64_t *counts, *maxima;

  __device__ void add(int index) const {
    const unsigned here = __activemask(), same = __match_any_sync(here, index);
    if ((threadIdx.x & 31) == static_cast<unsigned>(__ffs(static_cast<int>(same)) - 1))
      atomicAdd(reinterpret_cast<unsigned long long*>(counts + index), static_cast<unsigned long long>(__popc(same)));
  }
  __device__ void most(int question, int which, double size) const {
    std::uint64_t* kept = maxima + question * band_maxima::kFields + which;
    const auto bits = static_cast<unsigned long long>(__double_as_longlong(size));
    if (bits > *const_cast<volatile std::uint64_t*>(kept)) atomicMax(reinterpret_cast<unsigned long long*>(kept), bits);
  }
};

struct DeviceRecords {
  const void* values;
  std::uint64_t stride;
  const RecordedPath* paths;
  const std::uint32_t *intersects, *declined;  // the lane's own verdicts
};

template <int algorithm, class Real, class Pairs>
__global__ void __launch_bounds__(128)
    compare_pairs(Pairs pairs, DeviceRecords first, DeviceRecords second, const std::uint8_t* degrees, Axis axis,
                  std::uint64_t* counts, std::uint64_t* maxima, std::uint64_t* unlike) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= pairs.count) return;
  const Triangles<Real> t = widened<Real>(pairs, i);
  for (int v = 0; v < 3; ++v) {
    for (int c = 0; c < 3; ++c) {
      if (!is_finite_value(component(t.a[v], c)) || !is_finite_value(component(t.b[v], c))) return;
    }
  }
  const DeviceRecords* of[2] = {&first, &second};
  Run<Real> runs[2];
  for (int lane = 0; lane < 2; ++lane) {
    runs[lane] = {{static_cast<const Real*>(of[lane]->values) + i, of[lane]->stride}, of[lane]->paths[i]};
    const bool yes = of[lane]->intersects[i / 32] >> i % 32 & 1, no_answer = of[lane]->declined[i / 32] >> i % 32 & 1;
    const Verdict said = no_answer ? Verdict::declined : yes ? Verdict::intersects : Verdict::disjoint;
    if (said != recorded_verdict(runs[lane].path.path))
      atomicAdd(reinterpret_cast<unsigned long long*>(unlike + lane), 1ull);
  }
  DeviceSink sink{counts, maxima};
  compare_runs<std::tuple_element_t<algorithm, Algorithms>>(t.a, t.b, runs[0], runs[1], degrees, axis, sink);
}

template <class Pairs>
using LaunchCompare = void (*)(Pairs pairs, const DeviceRecords& first, const DeviceRecords& second,
                               const std::uint8_t* degrees, Axis axis, std::uint64_t* counts, std::uint64_t* maxima,
                               std::uint64_t* unlike);

template <int algorithm, class Real, class Pairs>
void launch_compare(Pairs pairs, const DeviceRecords& first, const DeviceRecords& second, const std::uint8_t* degrees,
                    Axis axis, std::uint64_t* counts, std::uint64_t* maxima, std::uint64_t* unlike) {
  compare_pairs<algorithm, Real>
      <<<(pairs.count + 127) / 128, 128>>>(pairs, first, second, degrees, axis, counts, maxima, unlike);
}

// Only lanes in double decide pairs of doubles, so the float entries for pairs of doubles are never called.
template <class Pairs, int... algorithm>
constexpr DeviceKernels<LaunchCompare<Pairs>> launchers(std::integer_sequence<int, algorithm...>) {
  return {std::array<LaunchCompare<Pairs>, 2>{launch_compare<algorithm, typename Pairs::Real, Pairs>,
                                              launch_compare<algorithm, double, Pairs>}...};
}

// Each thread hashes the records of one pair: the path and the values of the questions.
template <class Word>
__global__ void hash_runs(const Word* values, std::uint64_t stride, const RecordedPath* paths, std::uint32_t count,
                          std::uint64_t two_values, std::uint64_t* hashes) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) hashes[i] = run_hash(values + i, stride, paths[i], two_values);
}

// The CUDA lane whose kernels compute this lane's values: the lane itself, or cuda-nofma for a host lane.
const Lane& on_device(const Lane& lane) { return lane.is_cuda() ? lane : *counterpart(lane, Variant::cuda_nofma); }

// The questions that compare two values: one bit for each question.
std::uint64_t two_values_of(int algorithm) {
  std::uint64_t bits = 0;
  const std::vector<Question>& questions = questions_of(algorithm);
  for (std::size_t q = 0; q < questions.size(); ++q) bits |= std::uint64_t{questions[q].of.size() == 2} << q;
  return bits;
}

// A lane's records for a block of pairs, on the device.
class DeviceRun {
 public:
  explicit DeviceRun(const Lane& lane) : lane_(on_device(lane)) {
    const std::size_t values = 2 * questions_of(lane.algorithm).size() * kPairsAtOnce;
    values_.at_least(lane.scalar == Scalar::f32 ? (values + 1) / 2 : values);
    paths_.at_least(kPairsAtOnce);
    bits_.at_least(kPairsAtOnce / 16);
  }
  template <class Pairs>
  DeviceRecords record(Pairs pairs, DeviceExact& exact) {
    std::uint32_t* intersects = bits_.at_least(0);
    std::uint32_t* declined = intersects + kPairsAtOnce / 32;
    launch_record(lane_, pairs, values_.at_least(0), kPairsAtOnce, paths_.at_least(0));
    launch_lane(lane_, exact, pairs, intersects, declined, nullptr);
    return {values_.at_least(0), kPairsAtOnce, paths_.at_least(0), intersects, declined};
  }

 private:
  const Lane& lane_;
  DeviceArray<double> values_;
  DeviceArray<RecordedPath> paths_;
  DeviceArray<std::uint32_t> bits_;
};

// Draws the source's pairs in blocks and calls with_block(pairs) for each block.
template <class Pairs, class WithBlock>
void for_each_block(const strata::PairSource& source, const WithBlock& with_block) {
  check(cudaSetDevice(0));
  Drawing drawing;
  DeviceArray<typename Pairs::Real> coordinates;
  auto* block = coordinates.at_least(std::size_t{kPairsAtOnce} * kCoordinates);
  for (std::uint64_t first = 0; first < source.pairs; first += kPairsAtOnce) {
    const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(kPairsAtOnce, source.pairs - first));
    drawing.draw(source, first, count, block, nullptr);
    with_block(Pairs{block, count, count});
    check(cudaGetLastError());
  }
}

// Implements count_discrepancies for pairs in this layout.
template <class Pairs>
void count_on_device(const Lane& first, const Lane& second, const strata::PairSource& source,
                     const DiscrepancySums& to) {
  static constexpr DeviceKernels<LaunchCompare<Pairs>> kCompare =
      launchers<Pairs>(std::make_integer_sequence<int, kAlgorithmCount>());
  const LaunchCompare<Pairs> compare =
      kCompare[static_cast<std::size_t>(first.algorithm)][static_cast<std::size_t>(first.scalar)];
  check(cudaSetDevice(0));
  const std::vector<std::uint8_t> degrees = degrees_of(first.algorithm);
  DeviceArray<std::uint8_t> degrees_on_device;
  DeviceArray<std::uint64_t> sums_on_device;
  check(cudaMemcpy(degrees_on_device.at_least(degrees.size()), degrees.data(), degrees.size(), cudaMemcpyHostToDevice));
  const std::span<std::uint64_t> parts[] = {to.counts, to.maxima, to.unlike};
  std::uint64_t* sums = sums_on_device.at_least(to.counts.size() + to.maxima.size() + to.unlike.size());
  std::uint64_t* places[3];
  for (int p = 0; p < 3; ++p) {
    places[p] = sums;
    check(cudaMemcpy(sums, parts[p].data(), parts[p].size_bytes(), cudaMemcpyHostToDevice));
    sums += parts[p].size();
  }
  DeviceExact exact;
  DeviceRun runs[2] = {DeviceRun(first), DeviceRun(second)};
  for_each_block<Pairs>(source, [&](Pairs pairs) {
    const DeviceRecords of_first = runs[0].record(pairs, exact), of_second = runs[1].record(pairs, exact);
    compare(pairs, of_first, of_second, degrees_on_device.at_least(0), source.axis, places[0], places[1], places[2]);
  });
  for (int p = 0; p < 3; ++p)
    check(cudaMemcpy(parts[p].data(), places[p], parts[p].size_bytes(), cudaMemcpyDeviceToHost));
}

// Implements count_different_runs for pairs in this layout. record: the function that records the host lane on them.
template <class Pairs>
std::uint64_t different_runs(const Lane& host, RecordFunction<BasicPair<typename Pairs::Real>> record,
                             const Lane& device, const strata::PairSource& source) {
  using Coordinate = typename Pairs::Real;
  const std::uint64_t two_values = two_values_of(host.algorithm);
  const std::size_t slots = 2 * questions_of(host.algorithm).size();
  const bool single = host.scalar == Scalar::f32;
  DeviceExact exact;
  DeviceRun run(device);
  DeviceArray<std::uint64_t> hashes_on_device;
  std::vector<std::uint64_t> hashes(kPairsAtOnce);
  std::vector<Coordinate> drawn(std::size_t{kPairsAtOnce} * kCoordinates);
  std::atomic<std::uint64_t> different = 0;
  for_each_block<Pairs>(source, [&](Pairs pairs) {
    const DeviceRecords records = run.record(pairs, exact);
    std::uint64_t* found = hashes_on_device.at_least(kPairsAtOnce);
    const std::uint32_t blocks = (pairs.count + kThreads - 1) / kThreads;
    if (single) {
      hash_runs<<<blocks, kThreads>>>(static_cast<const float*>(records.values), records.stride, records.paths,
                                      pairs.count, two_values, found);
    } else {
      hash_runs<<<blocks, kThreads>>>(static_cast<const double*>(records.values), records.stride, records.paths,
                                      pairs.count, two_values, found);
    }
    check(cudaMemcpy(hashes.data(), found, pairs.count * sizeof *found, cudaMemcpyDeviceToHost));
    check(cudaMemcpy(drawn.data(), pairs.coordinates, std::size_t{kCoordinates} * pairs.count * sizeof(Coordinate),
                     cudaMemcpyDeviceToHost));
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, pairs.count, 256), [&](const auto& range) {
      const std::size_t count = range.size();
      std::vector<BasicPair<Coordinate>> block(count);
      for (std::size_t c = 0; c < kCoordinates; ++c) {
        for (std::size_t i = 0; i < count; ++i) coordinates(block[i])[c] = drawn[c * pairs.count + range.begin() + i];
      }
      std::vector<double> values(slots * count);
      std::vector<RecordedPath> paths(count);
      record(block.data(), count, {values.data(), count, paths.data()});
      std::uint64_t others = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t hash =
            single ? run_hash(reinterpret_cast<const float*>(values.data()) + i, count, paths[i], two_values)
                   : run_hash(values.data() + i, count, paths[i], two_values);
        others += hash != hashes[range.begin() + i];
      }
      different += others;
    });
  });
  return different;
}

}  // namespace
}  // namespace GRAZE_FP

bool records_on_device(const Lane& lane) {
  if (lane.algorithm < 0 || lane.under) return false;
  return lane.is_cuda() || info_of(lane.variant).arithmetic == Arithmetic::rounded;
}

void count_discrepancies(const Lane& first, const Lane& second, const strata::PairSource& source,
                         const DiscrepancySums& to) {
  source.in_doubles() ? count_on_device<DeviceDoubles>(first, second, source, to)
                      : count_on_device<DevicePairs>(first, second, source, to);
}

std::uint64_t count_different_runs(const Lane& host, const Lane& device, const strata::PairSource& source) {
  return source.in_doubles() ? different_runs<DeviceDoubles>(host, host_record_of_doubles(host), device, source)
                             : different_runs<DevicePairs>(host, host_record(host), device, source);
}

}  // namespace graze::cuda
