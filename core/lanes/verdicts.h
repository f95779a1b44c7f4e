// SPDX-License-Identifier: Apache-2.0
// A lane's verdicts on pairs as a list, for code that reads single verdicts instead of counting bits.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze {

// The verdict on each pair. Does not call the block function if there are no pairs.
std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs);

// The verdict of that name; nothing if there is none.
std::optional<Verdict> verdict_named(std::string_view word);

}  // namespace graze
