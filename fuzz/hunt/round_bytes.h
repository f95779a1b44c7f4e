// SPDX-License-Identifier: Apache-2.0
// Rounds as bytes: what a round's process hands over, and what a hunt keeps of a round (CBOR, with a checksum).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fuzz/hunt/round.h"

namespace graze::fuzz {

std::string error_bytes(const std::string& what, bool apart);
std::string result_bytes(const RoundResult& result);
// Throws: what error_bytes was made of; Damaged.
RoundResult parse_result(const std::string& bytes, const RoundTask& task);

// A kind of failure when it was found first.
struct NewKind {
  std::string key;  // see kinds.h
  std::uint64_t index = 0;
  Mutation mutation = Mutation::fresh;
};

// What is kept of a round besides its counts, which the campaign's store has.
struct KeptRound {
  std::uint64_t first = 0, pairs = 0;
  std::vector<Unit> units;                  // that showed something new when rounds were put together
  std::map<std::uint64_t, FoundPair> kept;  // cases
  std::array<MutationCounts, kMutationCount> mutations{};
  std::vector<std::string> coarse;  // signatures without margins that no round before had
  std::vector<NewKind> kinds;
};

// campaign: the checksum of what the hunt is of.
std::string round_bytes(const KeptRound& round, std::uint64_t campaign);
// Returns: nothing for bytes that round_bytes did not make, of this campaign.
std::optional<KeptRound> parse_round(const std::string& bytes, std::uint64_t campaign);

}  // namespace graze::fuzz
