// SPDX-License-Identifier: Apache-2.0
// Records a lane's run: each comparison, and each value passed to its policy, in the lane's own arithmetic.
#pragma once

#include "core/algorithms/traced.h"
#include "core/any_pair.h"
#include "core/lanes/lanes.h"

namespace graze::analysis {

// How certain it is that a replay matches the lane's own run.
// source   lane and replay both run the algorithm's source without contraction
// hash     the replay contracts by a rule, and the values passed to the policy have the same hash as in the lane's twin
// verdict  the replay contracts by a rule, and gives the lane's verdict; its values may differ
// none     no rule reproduces even the verdict
enum class Evidence { source, hash, verdict, none };
std::string_view name(Evidence evidence);
std::string_view name(Contraction rule);

struct Replay {
  Contraction rule = Contraction::none;
  Evidence evidence = Evidence::none;
  Trace<double> run;
};

// Whether the lane decides the pair as float32 stores it, not the pair itself.
inline bool decides_stored(const Lane& lane, const AnyPair& pair) { return lane.scalar == Scalar::f32 && !pair.floats; }

// The pair that the lane decides.
AnyPair seen_by(const Lane& lane, const AnyPair& pair);

// Whether the lane is an exact lane that decides the pair itself, not the pair as float32 stores it.
inline bool is_never_wrong(const Lane& lane, const AnyPair& pair) { return lane.exact && !decides_stored(lane, pair); }

// The lane's verdicts on the pairs as it sees them, from its own block or its twin's.
std::vector<Verdict> verdicts_seen_by(const Lane& lane, const DecideBlock& block, std::span<const Pair> pairs);
std::vector<Verdict> verdicts_seen_by(const Lane& lane, const DecideBlock& block, std::span<const DoublePair> pairs);

// The number of pairs that foreign code gets at once. Each pair may time out, so the number is small until the code has
// answered some pairs in time.
constexpr std::size_t foreign_at_once(bool prompt) { return prompt ? 64 : 8; }

// Replays the lane on the pair. A lane whose operations the compiler may rewrite gets Evidence::none.
// Requires, also for run_led: the pair is seen_by(lane, pair).
Replay replay(const Lane& lane, const AnyPair& pair);

// Runs the algorithm in the lane's scalar with the given contraction rule, and forces the outcomes of the path `lead`.
Trace<double> run_led(const Lane& lane, const AnyPair& pair, Contraction rule, const Path& lead);

// Returns the lane's own block on the host; for CUDA lanes, the twin's.   Throws: std::invalid_argument if there is no
// such block.
DecideBlock block_of(const Lane& lane);

// Decides the pair on the host; CUDA lanes use the twin.   Throws: std::invalid_argument if the lane has neither.
Verdict decide_lane(const Lane& lane, const AnyPair& pair);

}  // namespace graze::analysis
