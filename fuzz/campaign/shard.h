// SPDX-License-Identifier: Apache-2.0
// A shard: the K-th of N parts of a campaign, which can run on any machine. Shard K/N has the K-th part of every
// source's indices. Together the N shards cover each index exactly once.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "fuzz/campaign/stored_counts.h"

namespace graze::fuzz {

inline constexpr std::uint64_t kMostShards = 1'000'000;

struct Shard {
  std::uint64_t number = 1, of = 1;  // 1 <= number <= of

  bool whole() const { return of == 1; }
  std::string name() const { return std::to_string(number) + '/' + std::to_string(of); }  // "3/16"
  auto operator<=>(const Shard&) const = default;
};

// Parses "3/16".   Returns: nothing if the text is not a shard, or N exceeds kMostShards.
std::optional<Shard> parse_shard(std::string_view text);

// The shard's range of indices in a source with this many pairs; possibly empty if there are fewer pairs than shards.
PairRange share_of(const Shard& shard, int source, std::uint64_t pairs);

}  // namespace graze::fuzz
