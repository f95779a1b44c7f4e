// SPDX-License-Identifier: Apache-2.0
// A lane's verdicts on a block of pairs: as bits, so that many can be counted at once, or as a list.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze {

// Bit i % 64 of word i / 64 belongs to pair i; unused bits are zero.
inline bool test_bit(std::span<const std::uint64_t> bits, std::size_t i) { return bits[i / 64] >> (i % 64) & 1; }

struct VerdictBits {
  std::vector<std::uint64_t> intersects, declined;
};

// Does not call the block function if there are no pairs.
void decide(const DecideBlock& block, std::span<const Pair> pairs, VerdictBits& to);
void decide(const DecideBlock& block, std::span<const DoublePair> pairs, VerdictBits& to);

// The verdicts that a lane's bits encode.
struct LaneVerdicts {
  std::span<const std::uint64_t> intersects, declined;
  const DecideBlock* foreign = nullptr;  // only for foreign code, which failed on a pair if both bits are set
  const Pair* pairs = nullptr;
  const DoublePair* doubles = nullptr;  // used instead of `pairs`

  Verdict at(std::size_t i) const {
    const bool yes = test_bit(intersects, i), none = test_bit(declined, i);
    if (!foreign) return verdict_of_bits(yes, none);
    return doubles ? foreign->verdict_of(yes, none, doubles[i]) : foreign->verdict_of(yes, none, pairs[i]);
  }
};

// The verdict on each pair. Does not call the block function if there are no pairs.
std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const Pair> pairs);
std::vector<Verdict> verdicts_of(const DecideBlock& block, std::span<const DoublePair> pairs);

// The verdict with that name; nothing if there is none.
std::optional<Verdict> verdict_named(std::string_view word);

}  // namespace graze
