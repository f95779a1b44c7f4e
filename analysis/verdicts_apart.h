// SPDX-License-Identifier: Apache-2.0
// Compares only the verdicts of two lanes, for code whose values are not recorded.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "analysis/sweep.h"
#include "core/counts.h"
#include "core/lanes/lanes.h"

namespace graze::analysis {

struct VerdictsApart {
  std::uint64_t pairs = 0;               // finite pairs
  std::uint64_t differs = 0;             // pairs on which the two verdicts differ
  Counts of[2];                          // each lane's errors
  std::optional<PairPlace> simplest;     // the simplest pair on which they differ
  std::uint64_t broken = 0, mended = 0;  // differing pairs on which only the second (first) lane is wrong
  std::optional<PairPlace> simplest_broken, simplest_mended;

  bool operator==(const VerdictsApart&) const = default;

  // Adds the counts, but does not change the simplest pairs.
  VerdictsApart& operator+=(const VerdictsApart& other) {
    pairs += other.pairs;
    differs += other.differs;
    broken += other.broken;
    mended += other.mended;
    for (int lane = 0; lane < 2; ++lane) of[lane] += other.of[lane];
    return *this;
  }
};

struct TwoDeciders {
  const Lane* lanes[2];
  DecideBlock decide[2];
};

// counts[source]. The exact decision gives the truth. Lanes in float decide pairs of doubles as float32 stores them.
// The result does not depend on the number of threads.   simpler: whether the first pair is simpler.
std::vector<VerdictsApart> verdicts_apart(const TwoDeciders& deciders, const std::vector<strata::PairSource>& sources,
                                          int threads,
                                          const std::function<bool(const AnyPair&, const AnyPair&)>& simpler);

}  // namespace graze::analysis
