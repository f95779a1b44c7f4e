// SPDX-License-Identifier: Apache-2.0
#include "analysis/lane_trace.h"

#include <algorithm>
#include <stdexcept>

#include "backends/backends.h"
#include "core/lanes/verdicts.h"
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
Trace<double> run_in(int algorithm, const DoublePair& pair, Contraction rule, const Path& lead) {
  if (rule == Contraction::nvcc) return run_traced<Real, Contraction::nvcc>(algorithm, pair, lead);
  if (rule == Contraction::left) return run_traced<Real, Contraction::left>(algorithm, pair, lead);
  return run_traced<Real>(algorithm, pair, lead);
}

// The evidence that this run of a contracted lane matches the lane's own.
Evidence evidence(const Lane& lane, const AnyPair& pair, const Trace<double>& run) {
  if (run.verdict != decide_lane(lane, pair)) return Evidence::none;
  if (!cuda::twin_row(lane).trace) return Evidence::verdict;
  std::uint64_t hash = 0;
  if (pair.floats) {
    cuda::twin_row(lane).trace(&*pair.floats, 1, &hash);
  } else {
    cuda::twin_row(lane).doubles.trace(&pair.doubles, 1, &hash);
  }
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

AnyPair seen_by(const Lane& lane, const AnyPair& pair) {
  return decides_stored(lane, pair) ? stored_in_float32(pair.doubles) : pair;
}

std::vector<Verdict> verdicts_seen_by(const Lane&, const DecideBlock& block, std::span<const Pair> pairs) {
  return verdicts_of(block, pairs);
}

std::vector<Verdict> verdicts_seen_by(const Lane& lane, const DecideBlock& block, std::span<const DoublePair> pairs) {
  if (lane.scalar == Scalar::f64) return verdicts_of(block, pairs);
  std::vector<Pair> stored(pairs.size());
  std::transform(pairs.begin(), pairs.end(), stored.begin(), stored_in_float32);
  return verdicts_of(block, stored);
}

Trace<double> run_led(const Lane& lane, const AnyPair& pair, Contraction rule, const Path& lead) {
  return lane.scalar == Scalar::f32 ? run_in<float>(lane.algorithm, pair.doubles, rule, lead)
                                    : run_in<double>(lane.algorithm, pair.doubles, rule, lead);
}

Replay replay(const Lane& lane, const AnyPair& pair) {
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
  if (!block) throw std::invalid_argument("cannot run " + lane.id + " here: it has neither a host lane nor a twin");
  return block;
}

Verdict decide_lane(const Lane& lane, const AnyPair& pair) {
  const DecideBlock block = block_of(lane);
  return visit(seen_by(lane, pair), [&](const auto& own) { return decide_one(block, own); });
}

}  // namespace graze::analysis
