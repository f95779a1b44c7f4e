// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/twin.h"

#include <fmt/format.h>

#include "core/error.h"
#include "cuda/twin/twin_table.h"

namespace graze::cuda {
namespace {

// What a record in cuda/proofs says of one kernel; see twin_generator/proofs.h.
struct Proof {
  std::string_view hash, trace_hash;
  std::string_view device, toolkit;
  double pairs;
};

constexpr Proof kProofs[] = {
#include "cuda/generated/twin_proofs.inc"
    {}};

const TwinTable& contracted() {
#if defined(__x86_64__)
  static const bool has_fma = __builtin_cpu_supports("fma");
  return has_fma ? kTwinsFma : kTwinsFmaPortable;
#else
  return kTwinsFmaPortable;
#endif
}

}  // namespace

const TwinRow& twin_row(int algorithm, Scalar scalar, Target target) {
  static const TwinRow kNone;
  const TwinTable* table = target == Target::cuda_fma     ? &contracted()
                           : target == Target::cuda_nofma ? &kTwinsNofma
                                                          : nullptr;
  return table ? table->rows.at(static_cast<std::size_t>(algorithm)).at(static_cast<std::size_t>(scalar)) : kNone;
}

DecideBlock twin_block(int algorithm, Scalar scalar, Target target) {
  return twin_row(algorithm, scalar, target).decide;
}
DecideBlock block_on_host(const Lane& lane) {
  if (lane.decide) return lane.decide;
  return lane.is_exact() ? (&lane - 1)->decide : twin_block(lane.algorithm, lane.scalar, lane.target);
}

TraceBlock twin_trace(int algorithm, Scalar scalar, Target target) { return twin_row(algorithm, scalar, target).trace; }
const char* twin_toolkit() { return contracted().toolkit; }
const char* twin_hash(int algorithm, Scalar scalar, Target target) { return twin_row(algorithm, scalar, target).hash; }
const char* twin_trace_hash(int algorithm, Scalar scalar, Target target) {
  return twin_row(algorithm, scalar, target).trace_hash;
}

std::string twin_evidence(int algorithm, Scalar scalar, Target target) {
  const TwinRow& row = twin_row(algorithm, scalar, target);
  for (const Proof& proof : kProofs) {
    if (row.decide && proof.hash == row.hash && proof.trace_hash == row.trace_hash) {
      return fmt::format("twin, verified on {}, nvcc {}, {:.3g} pairs", proof.device, proof.toolkit, proof.pairs);
    }
  }
  return "twin";
}

std::span<const ContractionSite> contraction_sites(int algorithm, Scalar scalar) {
  return twin_row(algorithm, scalar, Target::cuda_fma).sites;
}

Verdict decide_fusing(int algorithm, Scalar scalar, const Pair& pair, std::span<const std::uint64_t> fused) {
  const TwinRow& row = twin_row(algorithm, scalar, Target::cuda_fma);
  if (!row.decide_fusing || fused.size() * 64 < row.sites.size())
    throw std::invalid_argument("decide_fusing: no such twin, or too few bits for its sites");
  return row.decide_fusing(pair, fused.data());
}

}  // namespace graze::cuda
