// SPDX-License-Identifier: Apache-2.0
// A policy, the last part of a lane's name, determines how a published algorithm compares with zero. A policy's numbers
// are read at run time, so sweeps need no compiler.
//   abs:E        values below E count as zero; E has the unit of the quantity compared (mostly lengths cubed)
//   rel:K        like abs:E, with E = K times machine epsilon times the quantity's size (core/lanes/with_magnitude.h)
//   SITE=abs:E,SITE=rel:K   tolerances at these sites only; the other sites compare with zero
//   paper        the tolerances of the algorithm's published code
//   bound        decides if certified error bounds suffice (core/lanes/with_error_bound.h); otherwise declines
//   filtered     like bound, but the exact decision decides the pairs that it declines
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/algorithms/algorithm.h"
#include "core/lanes/tolerances.h"

namespace graze {

// Policies with a name. All other policies are tolerances ("rel:8").
inline constexpr std::string_view kNamedPolicies[] = {"paper", "bound", "filtered"};

struct Policy {
  enum class Kind { tolerances, bound, filtered };
  Kind kind = Kind::tolerances;
  Epsilons epsilons;  // only for the kind `tolerances`
};

// Throws: UsageError for an invalid text, or if the algorithm cannot have the policy.
Policy parse_policy(std::string_view text, const AlgorithmInfo& info);

}  // namespace graze
