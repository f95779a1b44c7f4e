// SPDX-License-Identifier: Apache-2.0
// Pairs a second of every CUDA lane on pairs that already lie in the device's memory, by stratum; and beside them what
// bounds them, the memory: a copy, and a kernel that only reads the pairs (72 bytes each) and writes a bit.
// The exact lane must first give the host's bits on a sample. Prints a line and succeeds where there is no device.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "build_info.h"
#include "core/exact.h"
#include "core/fnv1a.h"
#include "core/lanes.h"
#include "cuda/device.h"
#include "cuda/device_memory.h"
#include "cuda/exact_kernels.h"
#include "cuda/kernels.h"
#include "cuda/prove_kernels.h"
#include "fuzz/strata.h"

namespace graze {
namespace {

constexpr std::uint32_t kPairs = 1u << 24;
constexpr std::size_t kFloats = std::size_t{kPairs} * kCoordinates;
constexpr std::uint32_t kSample = 1u << 16;
constexpr int kLaunches = 4;  // timed together, so that a launch's own microseconds do not count

// The pairs of one stratum at a time, and the memory that the lanes write.
struct Resident {
  int stratum = -1;
  DeviceArray<float> coordinates, copy;
  DeviceArray<std::uint32_t> intersects, declined;
  DeviceArray<unsigned long long> stages;
  DeviceExact exact;

  DevicePairs pairs() { return {coordinates.at_least(kFloats), kPairs, kPairs}; }
  std::uint32_t* intersects_bits() { return intersects.at_least(kPairs / 32); }
  std::uint32_t* declined_bits() { return declined.at_least(kPairs / 32); }

  void hold(int wanted, std::uint64_t first = 0) {
    if (stratum == wanted && first == 0) return;
    launch_generate(coordinates.at_least(kFloats), kPairs, 1, wanted, first, nullptr);
    check(cudaGetLastError());
    check(cudaDeviceSynchronize());
    stratum = wanted;
  }
};

__global__ void read_pairs(DevicePairs pairs, std::uint32_t* bits) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  float sum = 0;
  for (int c = 0; c < kCoordinates; ++c) sum += pairs.coordinates[std::size_t(c) * pairs.stride + i];
  const std::uint32_t word = __ballot_sync(0xffffffffu, sum > 0);
  if (threadIdx.x % 32 == 0) bits[i / 32] = word;
}

class Event {
 public:
  Event() { check(cudaEventCreate(&event_)); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { cudaEventDestroy(event_); }
  operator cudaEvent_t() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

// Counts items (pairs) and bytes for each launch.
template <class Launch>
void measure(benchmark::State& state, double items, double bytes, const Launch& launch) {
  const Event start, stop;
  launch();  // the first one allocates
  check(cudaDeviceSynchronize());
  for (auto _ : state) {
    check(cudaEventRecord(start));
    for (int i = 0; i < kLaunches; ++i) launch();
    check(cudaEventRecord(stop));
    check(cudaEventSynchronize(stop));
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, start, stop));
    state.SetIterationTime(milliseconds / 1000.0);
  }
  const double launches = static_cast<double>(state.iterations()) * kLaunches;
  state.SetItemsProcessed(static_cast<std::int64_t>(launches * items));
  state.SetBytesProcessed(static_cast<std::int64_t>(launches * bytes));
}

using Bits = std::vector<std::uint64_t>;

// The verdicts of resident pairs [first, first + count): on the device, and by the host's exact lane.
// Requires: first and count are multiples of 64.
struct Verdicts {
  Bits device, host;
};
Verdicts verdicts(Resident& resident, const Lane& host, std::size_t first, std::size_t count) {
  std::vector<Pair> pairs(count);
  std::vector<float> column(count);
  for (std::size_t c = 0; c < kCoordinates; ++c) {
    check(cudaMemcpy(column.data(), resident.pairs().coordinates + c * kPairs + first, count * sizeof(float),
                     cudaMemcpyDeviceToHost));
    for (std::size_t i = 0; i < count; ++i) coordinates(pairs[i])[c] = column[i];
  }
  Verdicts v{Bits(count / 64), Bits(count / 64)};
  check(cudaMemcpy(v.device.data(), resident.intersects_bits() + first / 32, count / 8, cudaMemcpyDeviceToHost));
  Bits declined(count / 64);
  host.decide(pairs.data(), count, v.host.data(), declined.data());
  return v;
}

// Decides the resident pairs, and returns in stages by whom.
void decide(Resident& resident, unsigned long long (&stages)[exact::kStages]) {
  unsigned long long* counts = resident.stages.at_least(exact::kStages);
  check(cudaMemset(counts, 0, sizeof stages));
  resident.exact.decide(resident.pairs(), resident.intersects_bits(), resident.declined_bits(), counts, nullptr);
  check(cudaMemcpy(stages, counts, sizeof stages, cudaMemcpyDeviceToHost));
}

// All pairs of every stratum, `rounds` times as many as are resident, by device and host: a line each with a hash of
// the verdicts.   Returns: whether none differs.
bool device_is_host(std::uint64_t rounds) {
  const Lane& host = *(&lanes().back() - 1);
  bool same = true;
  for (int stratum = 0; stratum < kStrataCount; ++stratum) {
    Resident resident;
    std::uint64_t differ = 0, hashes[2] = {fnv1a(""), fnv1a("")};
    for (std::uint64_t round = 0; round < rounds; ++round) {
      resident.hold(stratum, round * kPairs);
      unsigned long long stages[exact::kStages];
      decide(resident, stages);
      constexpr std::size_t kPart = 1 << 18;
      std::vector<Verdicts> parts(kPairs / kPart);
      std::atomic<std::size_t> next = 0;
      std::vector<std::jthread> threads;
      for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t) {
        threads.emplace_back([&] {
          for (std::size_t p = next++; p < parts.size(); p = next++)
            parts[p] = verdicts(resident, host, p * kPart, kPart);
        });
      }
      threads.clear();
      for (const Verdicts& v : parts) {
        for (std::size_t w = 0; w < v.host.size(); ++w)
          differ += static_cast<std::uint64_t>(std::popcount(v.host[w] ^ v.device[w]));
        const auto bytes = [](const Bits& bits) {
          return std::string_view(reinterpret_cast<const char*>(bits.data()), bits.size() * sizeof bits[0]);
        };
        hashes[0] = fnv1a(bytes(v.device), hashes[0]);
        hashes[1] = fnv1a(bytes(v.host), hashes[1]);
      }
    }
    std::cout << kStrata[stratum].id << ": " << rounds * kPairs << " pairs, " << differ << " differ, hashes "
              << std::hex << hashes[0] << ' ' << hashes[1] << std::dec << std::endl;
    same = same && differ == 0 && hashes[0] == hashes[1];
  }
  return same;
}

void measure_lane(benchmark::State& state, Resident& resident, int stratum, const Lane& lane) {
  resident.hold(stratum);
  if (lane.is_exact()) {
    unsigned long long stages[exact::kStages];
    const Lane& host = *(&lane - 1);  // exact/f32/cpu stands before exact/f32/cuda
    decide(resident, stages);
    const Verdicts v = verdicts(resident, host, 0, kSample);
    if (v.device != v.host) return state.SkipWithError("differs from the host's exact lane");
    constexpr const char* kNames[] = {"bounded", "doubles", "int128", "wide"};
    for (int s = 0; s < exact::kStages; ++s) state.counters[kNames[s]] = static_cast<double>(stages[s]);
  }
  measure(state, kPairs, double{kPairs} * sizeof(Pair), [&] {
    launch_lane(lane, resident.exact, resident.pairs(), resident.intersects_bits(), resident.declined_bits(), nullptr);
  });
}

template <class Function>
void add(const std::string& name, Function function) {
  benchmark::RegisterBenchmark(name.c_str(), function)->UseManualTime()->Unit(benchmark::kMicrosecond);
}

void add_all(Resident& resident) {
  constexpr double kBytes = double{kFloats} * sizeof(float);
  add("copy/memory", [&](benchmark::State& state) {
    resident.hold(0);
    measure(state, kPairs, 2 * kBytes, [&] {
      check(cudaMemcpyAsync(resident.copy.at_least(kFloats), resident.pairs().coordinates, kFloats * sizeof(float),
                            cudaMemcpyDeviceToDevice));
    });
  });
  add("read/memory", [&](benchmark::State& state) {
    resident.hold(0);
    measure(state, kPairs, kBytes, [&] {
      read_pairs<<<kPairs / kThreads, kThreads>>>(resident.pairs(), resident.intersects_bits());
      check(cudaGetLastError());
    });
  });
  for (int stratum = 0; stratum < kStrataCount; ++stratum) {
    for (const Lane& lane : lanes()) {
      if (!lane.is_cuda()) continue;
      add(lane.id + '/' + std::string(kStrata[stratum].id),
          [&resident, &lane, stratum](benchmark::State& state) { measure_lane(state, resident, stratum, lane); });
    }
  }
}

}  // namespace
}  // namespace graze

// `graze_device_bench compare ROUNDS` compares the exact lanes of device and host instead of measuring.
int main(int argc, char** argv) try {
  const bool compare = argc == 3 && std::string_view(argv[1]) == "compare";
  if (compare) return graze::device_is_host(std::stoull(argv[2])) ? 0 : 1;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  std::string why_not;
  const std::unique_ptr<graze::Device> device = graze::open_device(why_not);
  if (!device) {
    std::cout << "graze_device_bench: skipped, " << why_not << '\n';
    return 0;
  }
  benchmark::AddCustomContext("device", device->name);
  benchmark::AddCustomContext("driver", device->driver);
  benchmark::AddCustomContext("nvcc", device->toolkit);
  benchmark::AddCustomContext("flags", GRAZE_FLAGS);
  benchmark::AddCustomContext("commit", GRAZE_COMMIT);
  graze::Resident resident;
  graze::add_all(resident);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
} catch (const std::exception& error) {
  std::cerr << "graze_device_bench: " << error.what() << '\n';
  return 1;
}
