// SPDX-License-Identifier: Apache-2.0
// Measures the speed of the twins and of the `cpu` lanes, on uniform and on near-touching pairs. Before a twin without
// contraction is measured, it must give the same verdicts as the cpu lane.
#include <benchmark/benchmark.h>

#include "core/lanes/verdicts.h"
#include "cuda/twin/twin.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

constexpr std::size_t kPairs = 1 << 14;

std::vector<Pair> pairs_of(strata::Stratum stratum) {
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; i < kPairs; ++i) pairs.push_back(strata::generate(1, stratum, i));
  return pairs;
}

void measure(benchmark::State& state, DecideBlock decide, strata::Stratum stratum, const Lane* same_as) {
  const std::vector<Pair> pairs = pairs_of(stratum);
  if (same_as && verdicts_of(decide, pairs) != verdicts_of(same_as->decide, pairs))
    return state.SkipWithError("the twin differs from the cpu lane");
  VerdictBits bits;
  for (auto _ : state) {
    graze::decide(decide, pairs, bits);
    benchmark::DoNotOptimize(bits);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kPairs));
}

const bool kRegistered = [] {
  for (strata::Stratum stratum : {strata::Stratum::uniform, strata::Stratum::near_edge_edge}) {
    const Lane* cpu = nullptr;
    for (const Lane& lane : lanes()) {
      if (lane.variant == Variant::cpu) cpu = &lane;
      const DecideBlock decide = lane.is_cuda()                 ? twin_row(lane).decide
                                 : lane.variant == Variant::cpu ? lane.decide
                                                                : nullptr;
      if (!decide) continue;
      const Lane* same_as = lane.variant == Variant::cuda_nofma ? cpu : nullptr;
      const std::string name =
          lane.id + (lane.is_cuda() ? " (twin)/" : "/") + std::string(strata::kStrata[static_cast<int>(stratum)].id);
      benchmark::RegisterBenchmark(name.c_str(),
                                   [=](benchmark::State& state) { measure(state, decide, stratum, same_as); });
    }
  }
  return true;
}();

}  // namespace
}  // namespace graze::cuda
