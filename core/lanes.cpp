// SPDX-License-Identifier: Apache-2.0
#include "core/lanes.h"

#include <fnmatch.h>

#include <algorithm>

#include "core/lanes_cpu.h"

namespace graze {
namespace {

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
  return table;
}

}  // namespace

std::string_view name(Scalar scalar) { return scalar == Scalar::f32 ? "f32" : "f64"; }

std::string_view name(Target target) {
  constexpr std::string_view kNames[] = {"cpu", "cpu-fma", "cuda-nofma", "cuda-fma"};
  return kNames[static_cast<int>(target)];
}

std::span<const Lane> lanes() {
  static const std::vector<Lane> table = make_lanes();
  return table;
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
