// SPDX-License-Identifier: Apache-2.0
// A lane's errors under many policies on the same pairs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/counts.h"
#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::analysis {

// A pair, given by its source and its index in the source.
struct PairPlace {
  int source = -1;
  std::uint64_t index = 0;
  friend auto operator<=>(const PairPlace&, const PairPlace&) = default;
};

struct PolicyErrors : Counts {
  std::string policy;  // empty: comparison with zero
  std::uint64_t pairs = 0;
  std::uint64_t fixed = 0, broken = 0;  // pairs that are right only with the policy; only without it
  std::optional<PairPlace> first_fixed, first_broken;

  double share_not_true() const {
    return pairs == 0 ? 0 : static_cast<double>(not_true()) / static_cast<double>(pairs);
  }
  bool changes_nothing() const { return fixed == 0 && broken == 0; }
  PolicyErrors& operator+=(const PolicyErrors& other);
  bool operator==(const PolicyErrors&) const = default;
};

// The verdicts of two lanes on the same pairs, under one policy that both lanes have.
struct Agreement {
  std::string policy;                         // empty: comparison with zero
  std::uint64_t pairs = 0, intersecting = 0;  // all pairs, and those that intersect
  std::uint64_t differing = 0;                // pairs on which the two verdicts differ
  std::uint64_t mended = 0, added = 0;        // pairs on which they differ only without a policy; only under this one
  Counts of[2];                               // each lane's errors
  std::optional<PairPlace> first;             // the first pair on which they differ

  Agreement& operator+=(const Agreement& other);
  bool operator==(const Agreement&) const = default;
};

using Sources = std::span<const strata::PairSource>;
using Policies = std::span<const std::string>;  // an empty policy compares with zero

// The pairs [first, first + count) of a source.
struct SourceBlock {
  int source;
  std::uint64_t first, count;
};

// All pairs of the sources, in blocks of at most `most` pairs.
std::vector<SourceBlock> blocks_of(Sources sources, std::uint64_t most);

std::uint64_t pairs_in(Sources sources);  // of all sources

bool any_in_doubles(Sources sources);

// The source with each of its pairs, of either type, replaced by change(pair). Only the host can draw its pairs.
template <class Change>
strata::PairSource changed(strata::PairSource source, const Change& change) {
  const auto drawn = [&](const auto& draw) {
    return [draw, change](std::uint64_t index) { return change(draw(index)); };
  };
  source.stratum = -1;
  if (source.in_doubles()) {
    source.double_pair = drawn(source.double_pair);
  } else {
    source.pair = drawn(source.pair);
  }
  return source;
}

// The errors under each policy, on all pairs of the sources.
using Sweep = std::function<std::vector<PolicyErrors>(Policies policies, Sources sources)>;

// The code that decides under a policy. foreign: the user's lane, whose failures and convention are then counted; null
// for our own lanes.
struct LaneDecider {
  DecideBlock block;
  const Lane* foreign;

  LaneDecider(DecideBlock of, const Lane* of_user = nullptr) : block(of), foreign(of_user) {}
};
inline LaneDecider decider_of(const Lane& lane) { return {lane.decide, lane.foreign ? &lane : nullptr}; }

using DecideUnder = std::function<LaneDecider(const std::string& policy)>;

// A sweep on the host. Each pair is drawn and judged once, then decided under each policy. The result does not depend
// on the number of threads (0: one on each core).
Sweep host_sweep(DecideUnder decide, int threads = 0);

// A sweep of a published lane on the host; CUDA lanes run as twins. Uses core/lanes/ladder.h where possible.
// The returned sweep throws UsageError for a policy that the lane cannot have.
Sweep host_sweep(const Lane& lane, int threads = 0);

// A pair on which a lane is not right under at least one of several policies.
struct NotRightPair {
  PairPlace place;
  bool intersects;
  std::vector<Verdict> verdicts;  // under each policy
};

struct NotRightPairs {
  std::uint64_t count = 0;          // the number of such pairs
  std::vector<NotRightPair> first;  // by place, at most kMostListed
  static constexpr std::size_t kMostListed = 1'000'000;

  NotRightPairs& operator+=(NotRightPairs other);
};

// Runs on the host; a CUDA lane runs as its twin. The result does not depend on the number of threads.
// Requires: a lane with a host lane or a twin under each policy.
NotRightPairs not_right_pairs(const Lane& lane, Policies policies, Sources sources, int threads = 0);
// Like the function above, for any lane.   decide: as for host_sweep.
NotRightPairs not_right_pairs(const DecideUnder& decide, Policies policies, Sources sources, int threads = 0);

// Compares two published lanes under each policy, on all pairs of the sources.
using AgreementSweep = std::function<std::vector<Agreement>(Policies policies, Sources sources)>;

// Runs on the host; CUDA lanes run as twins. The result does not depend on the number of threads.
// Requires: lanes that outlive the sweep, with a host lane or a twin under each policy.
AgreementSweep agreement_sweep(const Lane& first, const Lane& second, int threads = 0);

// A sweep on the first CUDA device. lane_of: returns the CUDA lane under a policy.
// The returned sweep throws std::runtime_error without a device.
Sweep device_sweep(std::function<Lane(const std::string& policy)> lane_of);

}  // namespace graze::analysis
