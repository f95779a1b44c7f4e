// SPDX-License-Identifier: Apache-2.0
// Feedback for guided search, in addition to branch coverage. A pair is kept if it has a feature that no earlier pair
// had. A pair's features are numbers for:
//   failures     how each subject's lanes are wrong together, with the contact and the shape
//   closeness    margin bucket and shape
//   sites        for each value or comparison passed to the policy: log2 of the ratio of its size to its error bound
//                (core/lanes/with_error_bound.h), in float32 and in float64
//   parting      for a wrong algorithm: the line of the first comparison with different outcomes in float32 and float64
//   contractions for a cuda-fma lane whose verdict differs from the same source without contraction: each contraction
//                site that changes the verdict when only this site is not fused
#pragma once

#include <cstdint>
#include <vector>

#include "fuzz/campaign/cpu_engine.h"

namespace graze::fuzz {

// A feature's number is the index of one of libFuzzer's extra counters; a few features share a number.
inline constexpr std::size_t kFeatures = std::size_t{1} << 16;
using Features = std::vector<std::uint16_t>;

class Feedback {
 public:
  explicit Feedback(const std::vector<const Lane*>& lanes);

  // Returns the features, sorted and distinct.   Requires: `found` belongs to the pair and these lanes.
  Features features(const AnyPair& pair, const PairJudge::Found& found) const;

 private:
  struct Fused {
    std::size_t lane, rounded;  // a cuda-fma lane, and the same source without contraction
  };
  std::vector<const Lane*> lanes_;
  std::vector<int> algorithms_;  // the distinct algorithms of the published lanes
  std::vector<Fused> fused_;
};

}  // namespace graze::fuzz
