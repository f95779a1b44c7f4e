// SPDX-License-Identifier: Apache-2.0
// A block of pairs with the data that the engine's steps share, in device or host memory; also the signatures' keys.
#pragma once

#include <cstdint>

#include "core/exact/nesting.h"
#include "core/margin/axis.h"
#include "cuda/engine/engine.h"
#include "cuda/engine/signature_table.h"
#include "cuda/lanes/pair_list.h"

namespace graze::cuda {

inline constexpr std::int8_t kUndecided = 127;  // marks an unknown bucket or extreme

// A lane's verdicts: bit i % 32 of word i / 32 belongs to pair i.
struct LaneWords {
  const std::uint32_t *intersects, *declined;
};

struct LaneTable {
  const LaneWords* lanes;
  std::uint32_t count;
  const LaneGroup* groups;
  std::uint32_t group_count;
};

// Indices of the pairs left to the host. `indices` has room for `size` of them; `count` also counts those that do not
// fit.
struct IndexList {
  std::uint64_t* indices;
  std::uint32_t size;
  std::uint32_t* count;
};

// The lists of pairs that one step leaves to a later step:
// - kOpenGaps, kOpenDepths: disjoint and intersecting pairs whose bucket single precision does not decide.
// - kTies: disjoint pairs whose bucket double precision does not decide either.
// - kCloseTies: pairs of kTies whose bucket is still open after double bounds along all directions.
// - kRelated: pairs whose relation is needed. kByBounds: pairs of kRelated with large grids.
// - kByDoubles to kByWide: pairs whose relation needs all axes, by the number type that represents them.
// - kDepths: intersecting pairs with a nonzero margin whose bucket double precision does not decide.
// - kCloseDepths: pairs of kDepths whose bucket is still open after double bounds along all axes.
enum EngineList {
  kOpenGaps,
  kOpenDepths,
  kTies,
  kCloseTies,
  kRelated,
  kByBounds,
  kByDoubles,
  kByResidues,
  kByInts,
  kByLong,
  kByWide,
  kDepths,
  kCloseDepths,
  kEngineLists
};

struct EngineBlock {
  static constexpr std::uint32_t kCountersOfLane = counters_of_lane(false);

  DevicePairs pairs;
  std::uint64_t first;  // index of the block's first pair
  const std::uint32_t* truth;
  std::uint32_t* wrong;  // pairs on which some lane is wrong
  std::int8_t* buckets;
  std::uint16_t* relations;  // with nestings; at the end, known for each pair on which some lane is wrong
  LaneTable lanes;
  PairList lists[kEngineLists];
  SignatureTable signatures;
  IndexList undecided;
  std::uint64_t* counts;  // in the order of EngineResult::counts
  Axis axis;
  std::int8_t* extremes;  // written and counted unless `axis` is none
  std::uint64_t* extreme_counts;
  std::uint64_t* disagreements;
};

// A block of pairs of doubles. `pairs` has these pairs rounded to float32; all other members are about the doubles.
struct DoubleEngineBlock : EngineBlock {
  static constexpr std::uint32_t kCountersOfLane = counters_of_lane(true);

  DeviceDoubles doubles;
  LaneWords stored;        // exact verdicts of the stored pairs; declined: beyond float32's range
  std::uint32_t* changed;  // pairs that float32 cannot store, or whose verdict changes when float32 stores them
  const std::uint32_t* const* changed_for_lane;  // `changed` for lanes in float32, null for lanes in double
};

inline constexpr std::uint32_t kCountersOfPairs = 2;

template <class Block = EngineBlock>
GRAZE_HD constexpr std::size_t engine_counters(std::size_t lanes) {
  return (kCountersOfPairs + Block::kCountersOfLane * lanes) * kBucketCount;
}

GRAZE_HD inline bool bit(const std::uint32_t* words, std::uint32_t i) { return words[i / 32] >> (i % 32) & 1; }

// A lane's verdict compared with the truth, as two bits of a key.
enum class Mark : std::uint8_t { right, false_positive, false_negative, declined };
inline constexpr std::uint32_t kMarksOfWord = 32;

GRAZE_HD inline Mark mark_of(const LaneWords& lane, std::uint32_t i, bool truth) {
  if (bit(lane.declined, i)) return Mark::declined;
  const bool says = bit(lane.intersects, i);
  return says == truth ? Mark::right : says ? Mark::false_positive : Mark::false_negative;
}

// Whether any mark in this word of a key stands for a wrong verdict. `declined` is not wrong.
GRAZE_HD constexpr bool any_wrong(std::uint64_t marks) { return ((marks ^ marks >> 1) & 0x5555555555555555u) != 0; }
static_assert(static_cast<int>(Mark::right) == 0 && static_cast<int>(Mark::declined) == 3);

constexpr Verdict verdict_of(Mark mark, Verdict truth) {
  return mark == Mark::declined         ? Verdict::declined
         : mark == Mark::right          ? truth
         : mark == Mark::false_positive ? Verdict::intersects
                                        : Verdict::disjoint;
}

// The number of words for the marks of a group with this many lanes.
constexpr std::uint32_t mark_words(std::uint32_t lanes) { return (lanes + kMarksOfWord - 1) / kMarksOfWord; }

// The first word of a signature's key: everything except the marks. group: the index of the lanes' group.
GRAZE_HD constexpr std::uint64_t packed(std::uint32_t group, std::uint16_t relation, Bucket bucket) {
  return static_cast<std::uint64_t>(bucket + kBucketMost) | std::uint64_t{relation} << 8 | std::uint64_t{group} << 32;
}

struct SignatureHead {
  std::uint32_t group;
  Relation relation;
  Nesting nesting;
  Bucket bucket;
};

constexpr SignatureHead unpacked(std::uint64_t word) {
  const auto bucket = static_cast<Bucket>(static_cast<int>(word & 255) - kBucketMost);
  const auto relation = static_cast<std::uint16_t>(word >> 8);
  return {static_cast<std::uint32_t>(word >> 32), unpacked_relation(relation & 127, sign_of(bucket)),
          unpacked_nesting(relation), bucket};
}

// The marks of pair i for up to 32 lanes of the group, starting with the group's lane 32 * word.
GRAZE_HD inline std::uint64_t marks(const EngineBlock& block, const LaneGroup& group, std::uint32_t word,
                                    std::uint32_t i, bool truth) {
  const std::uint32_t from = word * kMarksOfWord;
  std::uint64_t result = 0;
  for (std::uint32_t k = 0; k < kMarksOfWord && from + k < group.count; ++k)
    result |= static_cast<std::uint64_t>(mark_of(block.lanes.lanes[group.first + from + k], i, truth)) << 2 * k;
  return result;
}

// The key of pair i's signature for one group of lanes. Marks after the first word are recomputed at each use, so that
// the number of registers does not depend on the number of lanes.
struct SignatureKey {
  const EngineBlock& block;
  LaneGroup group;
  std::uint32_t i;
  bool truth;
  std::uint64_t shape, first_marks;

  GRAZE_HD SignatureKey(const EngineBlock& b, std::uint32_t g, std::uint32_t pair)
      : block(b),
        group(b.lanes.groups[g]),
        i(pair),
        truth(bit(b.truth, pair)),
        shape(packed(g, b.relations[pair], b.buckets[pair])),
        first_marks(marks(b, group, 0, pair, truth)) {}

  GRAZE_HD bool any_wrong() const {
    bool any = graze::cuda::any_wrong(first_marks);
    for (std::uint32_t w = 1; !any && w * kMarksOfWord < group.count; ++w)
      any = graze::cuda::any_wrong(marks(block, group, w, i, truth));
    return any;
  }
  GRAZE_HD std::uint64_t word(std::uint32_t k) const {
    return k == 0 ? shape : k == 1 ? first_marks : marks(block, group, k - 1, i, truth);
  }
};

}  // namespace graze::cuda
