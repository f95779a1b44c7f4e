// SPDX-License-Identifier: Apache-2.0
// Measures how long a sweep of 64 tolerances takes on one core, for each algorithm.
#include "analysis/sweep.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>

#include "core/lanes/lanes.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

void sweep_of_64(benchmark::State& state, const Lane& lane, const char* form) {
  constexpr std::uint64_t kPairs = 100'000;
  const auto sources = strata::stratum_sources(1, kPairs, {"near_*"});
  std::vector<std::string> policies;
  for (int k = 0; k < 64; ++k) policies.push_back(fmt::format("{}:{}", form, std::exp2(-60 + k * 1.25)));
  const Sweep sweep = host_sweep(lane, 1);
  for (auto _ : state) benchmark::DoNotOptimize(sweep(policies, sources));
  state.counters["s per 10^6 pairs"] = benchmark::Counter(static_cast<double>(state.iterations() * kPairs) / 1e6,
                                                          benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const bool registered = [] {
  for (const Lane& lane : published_lanes()) {
    if (lane.variant != Variant::cpu) continue;
    for (const char* form : {"abs", "rel"}) {
      benchmark::RegisterBenchmark(fmt::format("sweep/{}/{}", lane.id, form).c_str(), [&lane,
                                                                                       form](benchmark::State& state) {
        sweep_of_64(state, lane, form);
      })->Unit(benchmark::kMillisecond);
    }
  }
  return true;
}();

}  // namespace
}  // namespace graze::analysis
