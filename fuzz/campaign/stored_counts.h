// SPDX-License-Identifier: Apache-2.0
// Converts the counts for a range of one source's pairs to bytes (CBOR) and back. Reading checks that all sums agree
// and that every index is in range.
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>

#include "fuzz/campaign/batch_result.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

// Thrown for stored bytes that are damaged or contradict each other; what() names the inconsistent counts.
struct Damaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The pairs [first, first + pairs) of a source.
struct PairRange {
  int source = 0;
  std::uint64_t first = 0, pairs = 0;
};

// Counts with signatures as text keys. Counts can be added in any order.
struct StoredCounts : CountsBy<std::string> {
  explicit StoredCounts(int lanes);
  StoredCounts(const BatchResult& result);
};

std::string to_bytes(const StoredCounts& counts);

// pairs: how many pairs the bytes count.   Requires: the range lies within the source and has at least `pairs` pairs.
// Throws: Damaged.
StoredCounts from_bytes(const std::string& bytes, const PairRange& range, std::uint64_t pairs, Axis axis, int lanes);
inline StoredCounts from_bytes(const std::string& bytes, const PairRange& range, Axis axis, int lanes) {
  return from_bytes(bytes, range, range.pairs, axis, lanes);
}

// A checksum of the range and its stored bytes, which any single change alters. campaign: the checksum of the
// campaign's identity.
std::uint64_t checksum(std::uint64_t campaign, const PairRange& range, const std::string& bytes);

}  // namespace graze::fuzz
