// SPDX-License-Identifier: Apache-2.0
// What lanes record of a block of pairs: every value that a comparison of theirs sees.
#pragma once

#include <cstddef>

#include "core/algorithms/recording.h"
#include "core/lanes/lanes.h"

namespace graze {

// Of pair i the value (question, which) is at values[(2 question + which) * stride + i], in the lane's scalar. Values
// of questions that were not asked keep what they were.
struct Records {
  void* values;
  std::uint64_t stride;  // at least the number of pairs
  RecordedPath* paths;
};

using RecordBlock = void (*)(const Pair* pairs, std::size_t count, const Records& to);

// Null for lanes of devices, of foreign code, of exact decisions and of policies.
RecordBlock host_record(const Lane& lane);

}  // namespace graze
