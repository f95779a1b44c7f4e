// SPDX-License-Identifier: Apache-2.0
// Which contractions make the difference between a cuda-fma lane and the same source without contraction.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {

struct Blame {
  std::vector<cuda::ContractionSite> sites;  // fused alone they give the lane's verdict; in program order
  bool smallest = true;                      // no smaller set does so
  std::string why_not;                       // "…", where the search did not come to its end
};

// Rather sites without which, all others being fused, the verdict is that of the source without contraction: of up to
// two, or else several sets of which each is enough. Of equally small ones the first in program order.
// Returns: no sites where the lane's verdict is that of its source without contraction.
// Requires: a cuda-fma lane with a twin.
// asked: called before each verdict.
Blame blame(const Lane& lane, const Pair& pair, const std::function<void()>& asked = {});

// The same of foreign code, which may crash or not come back with some of its operations fused: in a process of its
// own, in which each verdict may take `seconds`.   Deterministic, of code that takes less.
Blame blame_apart(const Lane& lane, const Pair& pair, double seconds);

}  // namespace graze::analysis
