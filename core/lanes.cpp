// SPDX-License-Identifier: Apache-2.0
#include "core/lanes.h"

#include <fnmatch.h>

#include <algorithm>

#include "core/exact/exact.h"
#include "core/host_blocks.h"

namespace graze {
namespace {

constexpr AlgorithmInfo kExactInfo{"exact",
                                   "Guigue and Devillers 2003, and separating axes, on exact numbers",
                                   "exact",
                                   "exact: segments and points",
                                   "does not depend on it",
                                   true};

void decide_exactly(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  for (std::size_t word = 0; word * 64 < count; ++word) {
    std::uint64_t yes = 0, no_answer = 0;
    for (std::size_t bit = 0; bit < 64 && word * 64 + bit < count; ++bit) {
      const Pair& pair = pairs[word * 64 + bit];
      const bool finite = is_finite(pair);
      yes |= std::uint64_t{finite && exact::intersects(&pair.a[0].x, &pair.b[0].x)} << bit;
      no_answer |= std::uint64_t{!finite} << bit;
    }
    intersects[word] = yes;
    declined[word] = no_answer;
  }
}

template <class... Algorithm>
std::vector<const AlgorithmInfo*> infos(const std::tuple<Algorithm...>*) {
  return {&Algorithm::kInfo...};
}

DecideBlock host_block(int algorithm, Scalar scalar, Target target) {
  const auto a = static_cast<std::size_t>(algorithm), s = static_cast<std::size_t>(scalar);
  return target == Target::cpu ? kBlocksCpu[a][s] : target == Target::cpu_fma ? kBlocksCpuFma[a][s] : nullptr;
}

std::vector<Lane> make_lanes() {
  std::vector<Lane> table;
  const auto info = infos(static_cast<const Algorithms*>(nullptr));
  for (int algorithm = 0; algorithm < kAlgorithmCount; ++algorithm) {
    for (Scalar scalar : {Scalar::f32, Scalar::f64}) {
      for (Target target : {Target::cpu, Target::cpu_fma, Target::cuda_nofma, Target::cuda_fma}) {
        const AlgorithmInfo* row = info[static_cast<std::size_t>(algorithm)];
        std::string id = std::string(row->id) + '/' + std::string(name(scalar)) + '/' + std::string(name(target));
        table.push_back({static_cast<int>(table.size()), std::move(id), row, algorithm, scalar, target,
                         host_block(algorithm, scalar, target)});
      }
    }
  }
  for (Target target : {Target::cpu, Target::cuda}) {
    table.push_back({static_cast<int>(table.size()), "exact/f32/" + std::string(name(target)), &kExactInfo,
                     kAlgorithmCount, Scalar::f32, target, target == Target::cpu ? decide_exactly : nullptr});
  }
  return table;
}

}  // namespace

bool Lane::is_exact() const { return algorithm == kAlgorithmCount; }

std::string_view name(Scalar scalar) { return scalar == Scalar::f32 ? "f32" : "f64"; }

std::string_view name(Target target) {
  constexpr std::string_view kNames[] = {"cpu", "cpu-fma", "cuda-nofma", "cuda-fma", "cuda"};
  return kNames[static_cast<int>(target)];
}

std::span<const Lane> lanes() {
  static const std::vector<Lane> table = make_lanes();
  return table;
}

std::span<const Lane> published_lanes() { return lanes().first(std::size_t{2} * kAlgorithmCount * kTargetCount); }

Verdict decide_one(DecideBlock block, const Pair& pair) {
  std::uint64_t intersects = 0, declined = 0;
  block(&pair, 1, &intersects, &declined);
  return verdict_of_bits(intersects & 1, declined & 1);
}

bool runs_on_this_cpu(const Lane& lane) {
#if defined(__x86_64__)
  return lane.target != Target::cpu_fma || __builtin_cpu_supports("fma");
#else
  return !lane.is_cuda();
#endif
}

bool matches_any(const std::vector<std::string>& globs, std::string_view id) {
  const std::string text(id);
  return globs.empty() || std::any_of(globs.begin(), globs.end(), [&](const std::string& glob) {
           return fnmatch(glob.c_str(), text.c_str(), 0) == 0;
         });
}

}  // namespace graze
