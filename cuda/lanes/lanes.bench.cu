// SPDX-License-Identifier: Apache-2.0
// Measures the pairs per second of each CUDA lane, by stratum, on pairs in device memory. Lanes in double also decide
// pairs of doubles. Two benchmarks show the memory's limits: a copy, and a kernel that only reads the pairs (72 or 144
// bytes each) and writes one bit for each. Before the exact lane is measured, it must give the host's verdicts on a
// sample. Without a device, the program prints a line and succeeds.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "build_info.h"
#include "core/exact/exact.h"
#include "core/fnv1a.h"
#include "core/lanes/lanes.h"
#include "cuda/engine/sweep.h"
#include "cuda/lanes/device.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/lanes/stratum_kernels.cuh"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

constexpr std::uint32_t kPairs = 1u << 24;
constexpr std::size_t kNumbers = std::size_t{kPairs} * kCoordinates;
constexpr std::uint32_t kSample = 1u << 16;
constexpr int kLaunches = 4;  // launches timed together, because each launch costs a few microseconds

std::span<const strata::StratumInfo> strata_of(float) { return strata::kStrata; }
std::span<const strata::StratumInfo> strata_of(double) { return strata::kDoubleStrata; }

template <class Real>
void draw(const strata::StratumInfo& stratum, std::uint64_t first, Real* to) {
  const std::string name = std::string(stratum.id) + std::string(sizeof(Real) == 8 ? strata::kInDoubles : "");
  Drawing().draw(strata::named_sources(1, kPairs, {name}).front(), first, kPairs, to, nullptr);
}

// The pairs of one stratum in device memory, and the memory to which the lanes write.
template <class Real>
struct Resident {
  using Block = std::conditional_t<std::is_same_v<Real, float>, DevicePairs, DeviceDoubles>;

  const strata::StratumInfo* stratum = nullptr;
  DeviceArray<Real> coordinates, copy;
  DeviceArray<std::uint32_t> intersects, declined;
  DeviceArray<unsigned long long> stages;
  DeviceExact exact;

  Block pairs() { return {coordinates.at_least(kNumbers), kPairs, kPairs}; }
  std::uint32_t* intersects_bits() { return intersects.at_least(kPairs / 32); }
  std::uint32_t* declined_bits() { return declined.at_least(kPairs / 32); }

  void hold(const strata::StratumInfo& wanted, std::uint64_t first = 0) {
    if (stratum == &wanted && first == 0) return;
    draw(wanted, first, coordinates.at_least(kNumbers));
    check(cudaDeviceSynchronize());
    stratum = &wanted;
  }
};

template <class Block>
__global__ void read_pairs(Block pairs, std::uint32_t* bits) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  auto sum = pairs.coordinates[i] * 0;
  for (int c = 0; c < kCoordinates; ++c) sum += pairs.coordinates[std::size_t(c) * pairs.stride + i];
  const std::uint32_t word = __ballot_sync(0xffffffffu, sum > 0);
  if (threadIdx.x % 32 == 0) bits[i / 32] = word;
}

// Measures the launch. `items` (pairs) and `bytes` are the amounts that one launch processes.
template <class Launch>
void measure(benchmark::State& state, double items, double bytes, const Launch& launch) {
  launch();  // the first launch allocates memory
  check(cudaDeviceSynchronize());
  for (auto _ : state) {
    const double milliseconds = timed(nullptr, [&] {
      for (int i = 0; i < kLaunches; ++i) launch();
    });
    state.SetIterationTime(milliseconds / 1000);
  }
  const double launches = static_cast<double>(state.iterations()) * kLaunches;
  state.SetItemsProcessed(static_cast<std::int64_t>(launches * items));
  state.SetBytesProcessed(static_cast<std::int64_t>(launches * bytes));
}

using Bits = std::vector<std::uint64_t>;

// Copies the first `count` pairs from the device to `columns`: 18 arrays of that length.
template <class Real>
void fetch(Resident<Real>& resident, std::size_t count, Real* columns) {
  check(cudaMemcpy2D(columns, count * sizeof(Real), resident.pairs().coordinates, kPairs * sizeof(Real),
                     count * sizeof(Real), kCoordinates, cudaMemcpyDeviceToHost));
}

// The verdicts of the host's exact lane on pairs [first, first + count) in columns of length `stride`.
// Requires: count is a multiple of 64.
template <class Real>
Bits by_host(const Lane& host, const Real* columns, std::size_t stride, std::size_t first, std::size_t count) {
  std::vector<BasicPair<Real>> pairs(count);
  for (std::size_t c = 0; c < kCoordinates; ++c) {
    for (std::size_t i = 0; i < count; ++i) coordinates(pairs[i])[c] = columns[c * stride + first + i];
  }
  Bits intersects(count / 64), declined(count / 64);
  host.decide(pairs.data(), count, intersects.data(), declined.data());
  return intersects;
}

template <class Real>
Bits by_device(Resident<Real>& resident, std::size_t count) {
  Bits intersects(count / 64);
  check(cudaMemcpy(intersects.data(), resident.intersects_bits(), count / 8, cudaMemcpyDeviceToHost));
  return intersects;
}

// Decides the pairs in device memory and returns how many pairs each stage decided.
template <class Real>
void decide(Resident<Real>& resident, unsigned long long (&stages)[exact::kStages]) {
  unsigned long long* counts = resident.stages.at_least(exact::kStages);
  check(cudaMemset(counts, 0, sizeof stages));
  resident.exact.decide(resident.pairs(), resident.intersects_bits(), resident.declined_bits(), counts, nullptr);
  check(cudaMemcpy(stages, counts, sizeof stages, cudaMemcpyDeviceToHost));
}

// Compares device and host in rounds [first, end) of every stratum; a round has kPairs pairs. Prints a line for each
// stratum, with hashes of the verdicts.   Returns: whether all verdicts are equal.
template <class Real>
bool device_is_host(std::uint64_t first, std::uint64_t end) {
  if (first >= end) throw std::invalid_argument("there are no rounds to compare: FIRST must be less than END");
  const Lane& host = *find_lane(std::is_same_v<Real, float> ? "exact/f32/cpu" : "exact/f64/cpu");
  const auto hashed = [](const Bits& bits, std::uint64_t hash) {
    return fnv1a({reinterpret_cast<const char*>(bits.data()), bits.size() * sizeof bits[0]}, hash);
  };
  Resident<Real> resident;
  PinnedArray<Real> pinned;
  Real* columns = pinned.at_least(kNumbers);
  bool same = true;
  for (const strata::StratumInfo& stratum : strata_of(Real())) {
    std::uint64_t differ = 0, hash_of_device = fnv1a(""), hash_of_host = fnv1a("");
    for (std::uint64_t round = first; round < end; ++round) {
      resident.hold(stratum, round * kPairs);
      unsigned long long stages[exact::kStages];
      decide(resident, stages);
      fetch(resident, kPairs, columns);
      constexpr std::size_t kPart = 1 << 16;
      std::vector<Bits> parts(kPairs / kPart);
      tbb::parallel_for(std::size_t{0}, parts.size(),
                        [&](std::size_t p) { parts[p] = by_host(host, columns, kPairs, p * kPart, kPart); });
      Bits of_host;
      for (const Bits& part : parts) of_host.insert(of_host.end(), part.begin(), part.end());
      Bits of_device(kPairs / 64);  // no pair may be declined, so each declined pair is a difference
      check(cudaMemcpy(of_device.data(), resident.declined_bits(), kPairs / 8, cudaMemcpyDeviceToHost));
      for (const std::uint64_t declined : of_device) differ += static_cast<std::uint64_t>(std::popcount(declined));
      of_device = by_device(resident, kPairs);
      for (std::size_t w = 0; w < of_host.size(); ++w)
        differ += static_cast<std::uint64_t>(std::popcount(of_host[w] ^ of_device[w]));
      hash_of_device = hashed(of_device, hash_of_device);
      hash_of_host = hashed(of_host, hash_of_host);
    }
    std::cout << stratum.id << ": " << (end - first) * kPairs << " pairs, " << differ << " differ, hashes " << std::hex
              << hash_of_device << ' ' << hash_of_host << std::dec << std::endl;
    same = same && differ == 0 && hash_of_device == hash_of_host;
  }
  return same;
}

template <class Real>
void measure_lane(benchmark::State& state, Resident<Real>& resident, const strata::StratumInfo& stratum,
                  const Lane& lane) {
  resident.hold(stratum);
  if (lane.exact) {
    unsigned long long stages[exact::kStages];
    const Lane& host = *counterpart(lane, Variant::cpu);
    decide(resident, stages);
    std::vector<Real> columns(kSample * kCoordinates);
    fetch(resident, kSample, columns.data());
    if (by_device(resident, kSample) != by_host(host, columns.data(), kSample, 0, kSample))
      return state.SkipWithError("differs from the host's exact lane");
    constexpr const char* kNames[] = {"bounded", "doubles", "int128", "wide"};
    for (int s = 0; s < exact::kStages; ++s) state.counters[kNames[s]] = static_cast<double>(stages[s]);
  }
  measure(state, kPairs, double{kPairs} * sizeof(BasicPair<Real>), [&] {
    launch_lane(lane, resident.exact, resident.pairs(), resident.intersects_bits(), resident.declined_bits(), nullptr);
  });
}

// Measures a sweep over 64 tolerances, including the time to draw and judge the pairs.
void measure_sweep(benchmark::State& state, const Lane& lane, const std::string& form) {
  strata::PairSource source = strata::stratum_sources(1, 1u << 28, {"near_edge_edge"}).front();
  std::vector<Lane> under;
  for (int k = 0; k < 64; ++k) {
    char tolerance[32];
    std::snprintf(tolerance, sizeof tolerance, ":%g", std::exp2(k * 1.25 - 60));
    under.push_back(lane_under(lane, form + tolerance));
  }
  std::uint64_t wrong = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    for (const ErrorCounts& counts : count_errors(lane, under, source)) wrong += counts.wrong();
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  if (wrong == 0) state.SkipWithError("expected wrong verdicts, found none");
  state.SetItemsProcessed(static_cast<std::int64_t>(static_cast<std::uint64_t>(state.iterations()) * source.pairs));
}

template <class Function>
void add(const std::string& name, Function function) {
  benchmark::RegisterBenchmark(name.c_str(), function)->UseManualTime()->Unit(benchmark::kMicrosecond);
}

// Registers the benchmarks on pairs of one type, whose names end with `suffix`.
template <class Real>
void add_of(Resident<Real>& resident, const std::string& suffix) {
  const std::span<const strata::StratumInfo> all = strata_of(Real());
  constexpr std::size_t kBytes = kNumbers * sizeof(Real);
  add("copy/memory" + suffix, [&resident, all](benchmark::State& state) {
    resident.hold(all[0]);
    measure(state, kPairs, 2.0 * kBytes, [&] {
      check(cudaMemcpyAsync(resident.copy.at_least(kNumbers), resident.pairs().coordinates, kBytes,
                            cudaMemcpyDeviceToDevice));
    });
  });
  add("read/memory" + suffix, [&resident, all](benchmark::State& state) {
    resident.hold(all[0]);
    measure(state, kPairs, double{kBytes}, [&] {
      read_pairs<<<kPairs / kThreads, kThreads>>>(resident.pairs(), resident.intersects_bits());
      check(cudaGetLastError());
    });
  });
  for (const strata::StratumInfo& stratum : all) {
    for (const Lane& lane : lanes()) {
      if (!lane.is_cuda() || (std::is_same_v<Real, double> && lane.scalar != Scalar::f64)) continue;
      add(lane.id + '/' + std::string(stratum.id) + suffix,
          [&resident, &lane, &stratum](benchmark::State& state) { measure_lane(state, resident, stratum, lane); });
    }
  }
}

void add_sweeps() {
  for (const char* form : {"abs", "rel"}) {
    for (const char* id : {"moller_1997/f32/cuda-fma", "guigue_devillers_2003/f32/cuda-fma"}) {
      add(std::string("sweep of 64 tolerances/") + id + '/' + form,
          [=](benchmark::State& state) { measure_sweep(state, *find_lane(id), form); });
    }
  }
}

}  // namespace
}  // namespace graze::cuda

// `graze_device_bench compare FIRST END` does not measure: it compares the exact lanes of device and host.
// `graze_device_bench compare_f64 FIRST END` does the same on pairs of doubles.
int main(int argc, char** argv) try {
  if (argc == 4 && std::string_view(argv[1]) == "compare")
    return graze::cuda::device_is_host<float>(std::stoull(argv[2]), std::stoull(argv[3])) ? 0 : 1;
  if (argc == 4 && std::string_view(argv[1]) == "compare_f64")
    return graze::cuda::device_is_host<double>(std::stoull(argv[2]), std::stoull(argv[3])) ? 0 : 1;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  std::string why_not;
  const std::unique_ptr<graze::cuda::Device> device = graze::cuda::open_device(why_not);
  if (!device) {
    std::cout << "graze_device_bench: skipped, " << why_not << '\n';
    return 0;
  }
  benchmark::AddCustomContext("device", device->name);
  benchmark::AddCustomContext("driver", device->driver);
  benchmark::AddCustomContext("nvcc", device->toolkit);
  benchmark::AddCustomContext("flags", GRAZE_FLAGS);
  benchmark::AddCustomContext("commit", GRAZE_COMMIT);
  graze::cuda::Resident<float> of_floats;
  graze::cuda::Resident<double> of_doubles;
  graze::cuda::add_of(of_floats, "");
  graze::cuda::add_sweeps();
  graze::cuda::add_of(of_doubles, std::string(graze::strata::kInDoubles));
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
} catch (const std::exception& error) {
  std::cerr << "graze_device_bench: " << error.what() << '\n';
  return 1;
}
