// SPDX-License-Identifier: Apache-2.0
// What guided search looks at besides branches: a pair is worth keeping when it shows something of these that no pair
// before did. Of a pair, as numbers:
//   failures     how each subject's lanes are wrong together, with the contact and the shape
//   closeness    margin bucket and shape
//   sites        of each value or comparison that an algorithm asks its policy about: log2 of how many times its error
//                bound (core/lanes/with_error_bound.h) it is away from zero, in float32 and in float64
//   parting      the line of the first comparison at which float32 and float64 part, of an algorithm that is wrong
//   contractions the contraction sites without which, all others fused, the verdict of a cuda-fma lane is another;
//   where
//                it is not that of the same source without contraction
#pragma once

#include <cstdint>
#include <vector>

#include "fuzz/campaign/cpu_engine.h"

namespace graze::fuzz {

// A feature is the place of an extra counter of libFuzzer; a few of them fall together.
inline constexpr std::size_t kFeatures = std::size_t{1} << 16;
using Features = std::vector<std::uint16_t>;

class Feedback {
 public:
  explicit Feedback(const std::vector<const Lane*>& lanes);

  // Sorted, each once.   Requires: found is of the pair and of these lanes.
  Features features(const Pair& pair, const PairJudge::Found& found) const;

 private:
  struct Fused {
    std::size_t lane, rounded;  // a cuda-fma lane, and the same source without contraction
  };
  std::vector<const Lane*> lanes_;
  std::vector<int> algorithms_;  // of the published lanes, each once
  std::vector<Fused> fused_;
};

}  // namespace graze::fuzz
