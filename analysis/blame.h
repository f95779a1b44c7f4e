// SPDX-License-Identifier: Apache-2.0
// Which contractions make the difference between a cuda-fma lane and the same source without contraction.
#pragma once

#include <vector>

#include "core/lanes.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {

struct Blame {
  std::vector<cuda::ContractionSite> sites;  // fused alone they give the lane's verdict; in program order
  bool smallest = true;                      // no smaller set does; otherwise only: no set that lacks one of these does
};

// Returns: no sites where the lane's verdict is that of its source without contraction.
// Requires: a cuda-fma lane with a twin. Of smallest sets it is the first in program order.
Blame blame(const Lane& lane, const Pair& pair);

}  // namespace graze::analysis
