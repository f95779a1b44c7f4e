// SPDX-License-Identifier: Apache-2.0
// Rounds as bytes (CBOR with a checksum): the result of a round's process, and the part that a hunt keeps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fuzz/hunt/round.h"

namespace graze::fuzz {

// The pair of floats or doubles stored in these bytes, distinguished by size; nothing for other sizes.
std::optional<AnyPair> pair_from(const void* bytes, std::size_t size);

std::string error_bytes(const std::string& what, bool apart);
std::string result_bytes(const RoundResult& result);
bool are_of_result(const std::string& bytes);  // whether result_bytes or error_bytes wrote them
// Throws: the error that error_bytes encoded; Damaged.
RoundResult parse_result(const std::string& bytes, const RoundTask& task);

// A kind of failure, and the pair on which it was first found.
struct NewKind {
  std::string key;  // see kinds.h
  std::uint64_t index = 0;
  Mutation mutation = Mutation::fresh;
};

// The part of a round that is kept in a file; the round's counts are in the campaign's store.
struct KeptRound {
  std::uint64_t first = 0, pairs = 0;
  std::vector<Unit> units;                  // pairs that were still new when rounds were combined
  std::map<std::uint64_t, FoundPair> kept;  // the cases, by pair index
  std::array<MutationCounts, kMutationCount> mutations{};
  std::vector<std::string> coarse;  // signatures without margins that no earlier round had
  std::vector<NewKind> kinds;
};

// campaign: the checksum of the hunt's identity.
std::string round_bytes(const KeptRound& round, std::uint64_t campaign);
// Returns: nothing unless round_bytes made the bytes for this campaign.
std::optional<KeptRound> parse_round(const std::string& bytes, std::uint64_t campaign);

}  // namespace graze::fuzz
