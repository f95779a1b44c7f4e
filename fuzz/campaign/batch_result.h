// SPDX-License-Identifier: Apache-2.0
// An engine's results for a batch of pairs. Results can be added in any order.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "analysis/signature.h"
#include "analysis/tally.h"

namespace graze::fuzz {

// For each signature, this many cases are kept: those with the smallest keys, regardless of the order of discovery.
inline constexpr std::size_t kKeptCases = 4;

// Identifies a pair: its source in the campaign, and its index in that source.
struct CaseKey {
  std::uint64_t index = 0;
  int source = 0;
  auto operator<=>(const CaseKey&) const = default;
};

struct SignatureCount {
  std::uint64_t count = 0;
  std::vector<CaseKey> cases;  // the smallest keys, sorted, at most kKeptCases

  void add(const CaseKey& found);
  void add(const SignatureCount& other);

 private:
  void keep(const CaseKey& found);
};

// A digest of each lane's verdicts on some pairs. Two runs on the same pairs with equal digests have the same verdicts.
// A digest is a sum of hashes, one for each pair whose verdict is not the truth, so parts can be added in any order. If
// a verdict differs, the digests are still equal with probability 2^-64.
struct VerdictDigests {
  std::vector<std::uint64_t> of_lane;
  std::uint64_t pairs = 0;  // pairs that the digests cover; excludes pairs judged by a GPU engine

  void add(std::size_t lane, std::uint64_t index, Verdict verdict);
  void add(const VerdictDigests& other);
};

// The counts of some pairs, without their signatures.
struct PairCounts {
  explicit PairCounts(const analysis::Tally& empty) : tally(empty), extremes(empty) {
    digests.of_lane.resize(static_cast<std::size_t>(empty.lane_count()));
  }
  void add(const PairCounts& other);

  analysis::Tally tally;
  analysis::Tally extremes;  // by place on the stratum's axis; empty without an axis
  VerdictDigests digests;
  std::uint64_t disagreements = 0;  // pairs on which some lane is wrong
  std::uint64_t cgal = 0;           // pairs decided by CGAL
  std::uint64_t gmp = 0;            // pairs confirmed by GMP
  std::uint64_t exact = 0;          // pairs decided by the exact lane, here or on a device
};

// The counts of some pairs, with their signatures.   Key: the type of a signature's key.
template <class Key>
struct CountsBy : PairCounts {
  using PairCounts::PairCounts;
  explicit CountsBy(const PairCounts& counts) : PairCounts(counts) {}
  void add(const CountsBy& other) {
    PairCounts::add(other);
    for (const auto& [key, found] : other.signatures) signatures[key].add(found);
    for (const auto& [lane, found] : other.executor_mismatches) executor_mismatches[lane].add(found);
  }

  std::map<Key, SignatureCount> signatures;
  std::map<std::string, SignatureCount> executor_mismatches;  // by lane: pairs on which device and twin differ
};

using BatchResult = CountsBy<analysis::Signature>;

}  // namespace graze::fuzz
