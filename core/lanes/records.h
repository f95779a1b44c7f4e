// SPDX-License-Identifier: Apache-2.0
// Records of lanes on a block of pairs: every value that one of their comparisons sees.
#pragma once

#include <cstddef>

#include "core/algorithms/recording.h"
#include "core/lanes/lanes.h"

namespace graze {

// The value (question, which) of pair i is at values[(2 question + which) * stride + i], in the lane's scalar type.
// Values of questions that were not asked stay unchanged.
struct Records {
  void* values;
  std::uint64_t stride;  // at least the number of pairs
  RecordedPath* paths;
};

template <class AnyPair>
using RecordFunction = void (*)(const AnyPair* pairs, std::size_t count, const Records& to);
using RecordBlock = RecordFunction<Pair>;

// Null for CUDA lanes, foreign code, exact lanes and lanes under a policy.
RecordBlock host_record(const Lane& lane);
RecordFunction<DoublePair> host_record_of_doubles(const Lane& lane);  // for a lane in double

}  // namespace graze
