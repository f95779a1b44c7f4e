// SPDX-License-Identifier: Apache-2.0
// Which contractions make the difference between a cuda-fma lane and the same source without contraction.
#pragma once

#include <vector>

#include "core/lanes.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {

struct Blame {
  std::vector<cuda::ContractionSite> sites;  // fused alone they give the lane's verdict; in program order
  bool smallest = true;                      // no smaller set does so
};

// Rather sites without which, all others being fused, the verdict is that of the source without contraction: of up to
// two, or else several sets of which each is enough. Of equally small ones the first in program order.
// Returns: no sites where the lane's verdict is that of its source without contraction.
// Requires: a cuda-fma lane with a twin.
Blame blame(const Lane& lane, const Pair& pair);

}  // namespace graze::analysis
