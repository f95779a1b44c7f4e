// SPDX-License-Identifier: Apache-2.0
// Which signatures of a campaign a report shows on a card of their own; the minimiser explains and maps their cases.
#pragma once

#include <vector>

#include "fuzz/campaign/store.h"

namespace graze::fuzz {

inline constexpr std::size_t kMostCards = 40;

// Places in summary["signatures"], ascending. The algorithms share kMostCards evenly; of its share each has three
// quarters for its commonest signatures, and one for the commonest others on which lanes of one scalar differ: there
// contraction decides.
// Requires: what summary.json holds.
std::vector<std::size_t> carded_signatures(const Json& summary);

}  // namespace graze::fuzz
