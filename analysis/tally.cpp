// SPDX-License-Identifier: Apache-2.0
#include "analysis/tally.h"

#include <algorithm>
#include <bit>

#include "core/judged_bits.h"

namespace graze::analysis {
namespace {

// Calls visit(i) for each set bit i of the word.
template <class Visit>
void for_each_bit(std::uint64_t word, Visit visit) {
  for (; word != 0; word &= word - 1) visit(static_cast<std::size_t>(std::countr_zero(word)));
}

}  // namespace

Tally::Tally(std::vector<int> cpu_twin)
    : cpu_twin_(std::move(cpu_twin)),
      pairs_(kBucketCount),
      intersects_(kBucketCount),
      lanes_(cpu_twin_.size() * kBucketCount) {}

void Tally::add(const JudgedBlock& block) {
  for (std::size_t i = 0; i < block.count; ++i) {
    ++pairs_[row(block.buckets[i])];
    intersects_[row(block.buckets[i])] += test_bit(block.truth, i);
  }
  for (std::size_t l = 0; l < block.verdicts.size(); ++l) {
    const LaneVerdicts& lane = block.verdicts[l];
    LaneCounts* counts = &lanes_[l * kBucketCount];
    for (std::size_t w = 0; w * 64 < block.count; ++w) {
      const std::uint64_t yes = lane.intersects[w], none = lane.declined[w], truth = block.truth[w];
      const JudgedBits bits = judge(yes, none, truth, ~std::uint64_t{0}, lane.foreign != nullptr);
      const auto at = [&](std::size_t i) -> LaneCounts& { return counts[row(block.buckets[w * 64 + i])]; };
      for_each_bit(bits.false_positive, [&](std::size_t i) { ++at(i).false_positive; });
      for_each_bit(bits.false_negative, [&](std::size_t i) { ++at(i).false_negative; });
      for_each_bit(bits.declined, [&](std::size_t i) { ++at(i).declined; });
      for_each_bit(bits.failed, [&](std::size_t i) { ++at(i).of(lane.at(w * 64 + i)); });
      if (!block.changed_by_storing.empty() && !lane.doubles)
        for_each_bit((bits.false_positive | bits.false_negative) & block.changed_by_storing[w],
                     [&](std::size_t i) { ++at(i).stored; });
      if (cpu_twin_[l] >= 0) {
        const LaneVerdicts& cpu = block.verdicts[static_cast<std::size_t>(cpu_twin_[l])];
        for_each_bit((yes ^ cpu.intersects[w]) | (none ^ cpu.declined[w]),
                     [&](std::size_t i) { ++at(i).differs_from_cpu; });
      }
    }
  }
}

void Tally::add(const Tally& other) {
  for (std::size_t b = 0; b < pairs_.size(); ++b) {
    pairs_[b] += other.pairs_[b];
    intersects_[b] += other.intersects_[b];
  }
  for (std::size_t i = 0; i < lanes_.size(); ++i) lanes_[i] += other.lanes_[i];
}

void Tally::add(Bucket b, std::uint64_t pairs, std::uint64_t intersects) {
  pairs_[row(b)] += pairs;
  intersects_[row(b)] += intersects;
}

void Tally::add(Bucket b, int lane, const LaneCounts& counts) {
  lanes_[static_cast<std::size_t>(lane) * kBucketCount + row(b)] += counts;
}

void Tally::excuse(Bucket b, int lane, Verdict verdict, bool stored) {
  LaneCounts& counts = lanes_[static_cast<std::size_t>(lane) * kBucketCount + row(b)];
  --counts.of(verdict);
  ++counts.by_convention;
  counts.stored -= stored;
}

Bits not_right(const JudgedBlock& block) {
  Bits any((block.count + 63) / 64);
  for (const LaneVerdicts& lane : block.verdicts) {
    for (std::size_t w = 0; w < any.size(); ++w) {
      const bool foreign = lane.foreign != nullptr;
      any[w] |= judge(lane.intersects[w], lane.declined[w], block.truth[w], ~std::uint64_t{0}, foreign).not_right();
    }
  }
  return any;
}

std::vector<int> cpu_twins(std::span<const Lane* const> lanes) {
  std::vector<int> twins(lanes.size(), -1);
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    const auto cpu = std::find(lanes.begin(), lanes.end(), counterpart(*lanes[l], Variant::cpu));
    if (cpu != lanes.end()) twins[l] = static_cast<int>(cpu - lanes.begin());
  }
  return twins;
}

}  // namespace graze::analysis
