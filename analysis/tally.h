// SPDX-License-Identifier: Apache-2.0
// Blocks of pairs with the truth and every lane's verdicts as bits, and tallies of such blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/counts.h"
#include "core/lanes/verdicts.h"
#include "core/margin/bucket.h"

namespace graze::analysis {

// Bit i % 64 of word i / 64 belongs to pair i; unused bits are zero.
using Bits = std::vector<std::uint64_t>;

struct JudgedBlock {
  std::size_t count = 0;
  std::span<const std::uint64_t> truth;    // whether each pair intersects
  std::span<const Bucket> buckets;         // buckets of the pairs' margins
  std::span<const LaneVerdicts> verdicts;  // verdicts of each lane under test
  // For pairs of doubles: those whose truth changes when float32 stores them, and those that float32 cannot store.
  // Lanes in float32 decide the stored pairs. Empty for pairs of float32.
  std::span<const std::uint64_t> changed_by_storing = {};
};

struct LaneCounts : Counts {
  std::uint64_t differs_from_cpu = 0;  // verdicts other than those of the cpu lane of the same algorithm and scalar
  std::uint64_t stored = 0;  // wrong verdicts that are right on the stored pair, or whose pair float32 cannot store

  bool any() const { return *this != LaneCounts{}; }
  LaneCounts& operator+=(const LaneCounts& other) {
    Counts::operator+=(other);
    differs_from_cpu += other.differs_from_cpu;
    stored += other.stored;
    return *this;
  }
  friend bool operator==(const LaneCounts&, const LaneCounts&) = default;
};

// Counts of pairs and of each lane's errors, by margin bucket. Tallies can be added in any order. Instead of the
// bucket, another small integer that belongs to a pair can be used (core/margin/axis.h).
class Tally {
 public:
  // cpu_twin[l]: the index of the cpu lane with the algorithm and scalar of lane l; -1 for none.
  explicit Tally(std::vector<int> cpu_twin);

  void add(const JudgedBlock& block);
  void add(const Tally& other);
  void add(Bucket b, std::uint64_t pairs, std::uint64_t intersects);
  void add(Bucket b, int lane, const LaneCounts& counts);
  // Moves one pair from the count of that verdict to `by_convention`.   stored: whether the pair was also counted in
  // `stored`.
  void excuse(Bucket b, int lane, Verdict verdict, bool stored = false);

  int lane_count() const { return static_cast<int>(cpu_twin_.size()); }
  std::uint64_t pairs(Bucket b) const { return pairs_[row(b)]; }
  std::uint64_t intersects(Bucket b) const { return intersects_[row(b)]; }
  const LaneCounts& lane(int l, Bucket b) const { return lanes_[static_cast<std::size_t>(l) * kBucketCount + row(b)]; }

 private:
  static std::size_t row(Bucket b) { return static_cast<std::size_t>(b + kBucketMost); }

  std::vector<int> cpu_twin_;
  std::vector<std::uint64_t> pairs_, intersects_;
  std::vector<LaneCounts> lanes_;
};

// The pairs on which some lane is wrong or declines.
Bits not_right(const JudgedBlock& block);

// For each lane, the index of its cpu lane in the list; see Tally.
std::vector<int> cpu_twins(std::span<const Lane* const> lanes);

}  // namespace graze::analysis
