// SPDX-License-Identifier: Apache-2.0
// The verdicts of a lane's code on pairs, one by one: where bits are read that are not counted as words.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze {

// Of each pair; none are asked where there are none.
std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs);

// The verdict of that name; nothing for another word.
std::optional<Verdict> verdict_named(std::string_view word);

}  // namespace graze
