// SPDX-License-Identifier: Apache-2.0
// Finds the contractions that make a cuda-fma lane differ from the same source without contraction.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {

struct Blame {
  std::vector<cuda::ContractionSite> sites;  // fusing only these gives the lane's verdict; in program order
  bool smallest = true;                      // whether no smaller set gives the verdict
  bool lines_decide = false;                 // whether rounding only these lines' products has
                                             // the same effect on the verdict as rounding all
  std::string why_not;                       // the reason if the search did not finish
};

// Prefers a set of one or two sites that is also necessary: with all other sites fused, the verdict is that of the
// source without contraction. Otherwise it may return the union of several sets, each of which is sufficient. Among
// equally small sets it returns the first in program order.
// Returns: no sites if the lane's verdict equals that of its source without contraction.
// Requires: a cuda-fma lane with a twin.
// asked: called before each verdict.
Blame blame(const Lane& lane, const AnyPair& pair, const std::function<void()>& asked = {});

// Like `blame`, for foreign code, which may crash or hang when some of its operations are fused. The search runs in a
// separate process, and each verdict may take at most `seconds`. Deterministic if no verdict times out.
Blame blame_apart(const Lane& lane, const AnyPair& pair, double seconds);

}  // namespace graze::analysis
