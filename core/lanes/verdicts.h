// SPDX-License-Identifier: Apache-2.0
// The verdicts of a lane's code on pairs, one by one: where bits are read that are not counted as words.
#pragma once

#include <span>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze {

// Of each pair; none are asked where there are none.
std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs);

}  // namespace graze
