// SPDX-License-Identifier: Apache-2.0
#include "analysis/lane_trace.h"

#include <stdexcept>

#include "backends/backends.h"
#include "cuda/lanes/trace.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {
namespace {

// The hash of cuda/lanes/trace.h, computed from a recorded run.
template <class Real>
std::uint64_t trace_hash(const Trace<double>& run) {
  std::uint64_t hash = 0;
  const cuda::TracePolicy policy{&hash};
  for (const Seen<double>& seen : run.seen) {
    if (!seen.site) continue;
    policy.fold(static_cast<Real>(seen.left));
    if (seen.compared) policy.fold(static_cast<Real>(seen.right));
  }
  return hash ^ static_cast<std::uint64_t>(run.verdict);
}

template <class Real>
Trace<double> run_in(int algorithm, const Pair& pair, Contraction rule, const Path& lead) {
  if (rule == Contraction::nvcc) return run_traced<Real, Contraction::nvcc>(algorithm, pair, lead);
  if (rule == Contraction::left) return run_traced<Real, Contraction::left>(algorithm, pair, lead);
  return run_traced<Real>(algorithm, pair, lead);
}

// The evidence that this run of a contracted lane is the lane's own.
Evidence evidence(const Lane& lane, const Pair& pair, const Trace<double>& run) {
  if (run.verdict != decide_lane(lane, pair)) return Evidence::none;
  const cuda::TraceBlock twin = cuda::twin_trace(lane);
  if (!twin) return Evidence::verdict;
  std::uint64_t hash = 0;
  twin(&pair, 1, &hash);
  return hash == (lane.scalar == Scalar::f32 ? trace_hash<float>(run) : trace_hash<double>(run)) ? Evidence::hash
                                                                                                 : Evidence::verdict;
}

}  // namespace

std::string_view name(Evidence evidence) {
  constexpr std::string_view kNames[] = {"source", "hash", "verdict", "none"};
  return kNames[static_cast<int>(evidence)];
}

std::string_view name(Contraction rule) {
  constexpr std::string_view kNames[] = {"none", "left", "nvcc"};
  return kNames[static_cast<int>(rule)];
}

Trace<double> run_led(const Lane& lane, const Pair& pair, Contraction rule, const Path& lead) {
  return lane.scalar == Scalar::f32 ? run_in<float>(lane.algorithm, pair, rule, lead)
                                    : run_in<double>(lane.algorithm, pair, rule, lead);
}

Replay replay(const Lane& lane, const Pair& pair) {
  if (info_of(lane.variant).arithmetic == Arithmetic::rounded)
    return {Contraction::none, Evidence::source, run_led(lane, pair, Contraction::none, {})};
  Replay best;
  if (!lane.explainable) return best;
  for (const Contraction rule : {Contraction::nvcc, Contraction::left}) {
    Trace<double> run = run_led(lane, pair, rule, {});
    const Evidence found = evidence(lane, pair, run);
    if (found < best.evidence || best.run.seen.empty()) best = {rule, found, std::move(run)};
  }
  return best;
}

DecideBlock block_of(const Lane& lane) {
  const DecideBlock block = backends::on_host(lane);
  if (!block) throw std::invalid_argument(lane.id + ": expected a host lane or a twin");
  return block;
}

Verdict decide_lane(const Lane& lane, const Pair& pair) { return decide_one(block_of(lane), pair); }

}  // namespace graze::analysis
