// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/shard.h"

#include <algorithm>

#include "core/text.h"

namespace graze::fuzz {

std::optional<Shard> parse_shard(std::string_view text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = parse_whole(text.substr(0, slash));
  const auto of = slash < text.size() ? parse_whole(text.substr(slash + 1)) : std::nullopt;
  if (!number || !of || *number < 1 || *number > *of || *of > kMostShards) return std::nullopt;
  return Shard{*number, *of};
}

PairRange share_of(const Shard& shard, int source, std::uint64_t pairs) {
  // Computes pairs * k / n without overflow, from the quotient and the remainder of pairs / n.
  const auto until = [&](std::uint64_t k) { return pairs / shard.of * k + pairs % shard.of * k / shard.of; };
  const std::uint64_t first = until(shard.number - 1);
  return {source, first, until(shard.number) - first};
}

}  // namespace graze::fuzz
