// SPDX-License-Identifier: Apache-2.0
// Policies by name, the last part of a lane's name: what a published algorithm does near zero. Their numbers are read
// at run time, so that a sweep compiles nothing.
//   abs:E        holds for zero what is smaller than E, in the unit of the quantity compared (lengths cubed, mostly)
//   rel:K        ... than K times machine epsilon times the quantity's size (core/lanes/with_magnitude.h)
//   SITE=abs:E,SITE=rel:K   at these sites alone; the others compare with zero
//   paper        what the algorithm's published code ships
//   bound        decides what certified error bounds settle (core/lanes/with_error_bound.h), and declines the rest
//   filtered     bound; what it declines the exact decision decides
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/algorithms/algorithm.h"
#include "core/lanes/tolerances.h"

namespace graze {

struct Policy {
  enum class Kind { tolerances, bound, filtered };
  Kind kind = Kind::tolerances;
  Epsilons epsilons;  // of tolerances
};

// Throws: UsageError with what was expected and found, or why the algorithm has no such policy.
Policy parse_policy(std::string_view text, const AlgorithmInfo& info);

}  // namespace graze
