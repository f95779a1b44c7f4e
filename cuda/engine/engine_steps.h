// SPDX-License-Identifier: Apache-2.0
// The engine's steps on a block of pairs. The same code runs on a device, where each step is a kernel, and on the host.
// Each pair's margin bucket is decided by the cheapest bounds that suffice. Each step lists the pairs that it leaves
// open, so that a warp does not wait for one hard pair in 32. The relation is computed only if a lane is wrong or the
// margin may be zero. The last steps count the pairs.
#pragma once

#include <type_traits>

#include "core/exact/exact.h"
#include "core/exact/find_nesting.h"
#include "core/judged_bits.h"
#include "core/margin/axis.h"
#include "core/margin/margin.h"
#include "core/margin/scaled_pair.h"
#include "core/margin/single_precision.h"
#include "core/margin/stored_margin.h"
#include "core/margin/tie_proof.h"
#include "cuda/engine/engine_block.h"

namespace graze::cuda {
inline namespace GRAZE_FP {

// kThreadBlocks: how many thread blocks a multiprocessor should run at once; this limits the step's registers.

struct MarkWrong {
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t word) const {
    std::uint32_t wrong = 0;
    for (std::uint32_t l = 0; l < block.lanes.count; ++l) {
      const LaneWords& lane = block.lanes.lanes[l];
      wrong |= judge(lane.intersects[word], lane.declined[word], block.truth[word], ~0u).wrong();
    }
    block.wrong[word] = wrong;
  }
};

template <class Real>
GRAZE_HD BasicPair<Real> pair_of(const Real* c) {
  return {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}},
          {{c[9], c[10], c[11]}, {c[12], c[13], c[14]}, {c[15], c[16], c[17]}}};
}

struct MeasureBySingle {
  static constexpr int kThreadBlocks = 2;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    Bucket bucket;
    const Verdict verdict = bit(block.truth, i) ? Verdict::intersects : Verdict::disjoint;
    if (!bucket_by_single(pair_of(c), verdict, bucket)) {
      bucket = kUndecided;
      block.lists[verdict == Verdict::intersects ? kOpenDepths : kOpenGaps].add(i);
    }
    block.buckets[i] = bucket;
    if (bit(block.wrong, i)) block.lists[kRelated].add(i);
  }
};

template <Verdict verdict>
struct MeasureByDouble {
  static constexpr int kThreadBlocks = 2;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    Bucket bucket;
    if (bucket_by_double(pair_of(c), verdict, bucket)) {
      block.buckets[i] = bucket;
    } else if (verdict == Verdict::disjoint) {
      block.lists[kTies].add(i);
    } else if (!bit(block.wrong, i)) {
      block.lists[kRelated].add(i);
    }
  }
};

GRAZE_HD inline void leave_to_host(const EngineBlock& block, std::uint32_t i) {
  const std::uint32_t n = add_one(block.undecided.count);
  if (n < block.undecided.size) block.undecided.indices[n] = block.first + i;
}

// The bucket if the bounds allow only one, else kUndecided. ulp: log2 of the pair's ulp.   Requires: a nonzero margin.
template <class Coordinate>
GRAZE_HD Bucket bucket_within(const Coordinate* c, const MarginBounds& bounds, Verdict verdict, int ulp) {
  const int upper = floor_log2(bounds.hi);
  Bucket bucket;
  if (bucket_from_bounds(bounds, verdict, ulp, bucket)) return bucket;
  if (verdict == Verdict::intersects) return upper - ulp <= kBucketLowest ? make_bucket(-1, kBucketLowest) : kUndecided;
  return are_apart_by(c, c + 9, bounds.direction, upper) ? make_bucket(1, upper - ulp) : kUndecided;
}

// The bucket from bounds along all axes and between all features, computed in type Real; kUndecided if they do not
// decide it.   Requires: a nonzero margin.
template <class Real>
GRAZE_HD Bucket bucket_by_bounds(const float* c, Verdict verdict) {
  const Pair pair = pair_of(c);
  const MarginBounds bounds = margin_bounds<Real>(pair, verdict);
  return bucket_within(c, bounds, verdict, log2_ulp(pair));
}

struct BreakTie {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    block.buckets[i] = bucket_by_bounds<double>(c, Verdict::disjoint);
    if (block.buckets[i] == kUndecided) block.lists[kCloseTies].add(i);
  }
};

// Whether the engine counts the pair's signatures. A pair without a known bucket is left to the host.
GRAZE_HD inline bool has_signatures(const EngineBlock& block, std::uint32_t i) {
  return bit(block.wrong, i) && block.buckets[i] != kUndecided;
}

// Finds the nesting of a pair on which a lane is wrong. For other pairs, no step needs the nesting.
// Returns: false if rounding leaves the nesting in doubt.
template <class Real>
GRAZE_HD bool nest_quickly(const EngineBlock& block, std::uint32_t i, const Real* c, const Relation& r,
                           Nesting& nesting) {
  nesting = Nesting::none;
  return !bit(block.wrong, i) || exact::detail::nesting_quickly(c, c + 9, r, nesting);
}

// Stores the relation. If an intersecting pair's bucket is open, sets it if the margin is zero, else lists the pair.
GRAZE_HD inline void settle(const EngineBlock& block, std::uint32_t i, const Relation& r, Nesting nesting) {
  block.relations[i] = packed(r, nesting);
  if (block.buckets[i] != kUndecided || !r.intersects()) return;
  if (r.margin_sign != 0) return block.lists[kDepths].add(i);
  block.buckets[i] = 0;
}

// The kinds of exact numbers that are fastest on a device.
using RelatingNumbers =
    exact::detail::NumberKinds<exact::detail::DoubleNumbers, exact::detail::ResidueNumbers, exact::detail::IntNumbers,
                               exact::detail::LongNumbers, exact::detail::WideNumbers>;

// The list for the smallest kind of these numbers that can represent the pair.
GRAZE_HD inline int list_by_numbers(const float* c) {
  return kByDoubles + RelatingNumbers::place(exact::detail::grid_of(c, c + 9));
}

struct Relate {
  static constexpr int kThreadBlocks = 2;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    Relation r;
    Nesting nesting;
    if (exact::detail::relate_quickly(c, c + 9, r) && nest_quickly(block, i, c, r, nesting))
      return settle(block, i, r, nesting);
    const int list = list_by_numbers(c);
    block.lists[list < kByLong ? list : kByBounds].add(i);
  }
};

struct RelateByBounds {
  static constexpr int kThreadBlocks = 2;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    Relation r;
    Nesting nesting;
    if (exact::detail::relate_by_bounds(c, c + 9, r) && nest_quickly(block, i, c, r, nesting))
      return settle(block, i, r, nesting);
    block.lists[list_by_numbers(c)].add(i);
  }
};

template <class Numbers, class Real>
GRAZE_HD void relate_by_axes(const EngineBlock& block, std::uint32_t i, const Real* c) {
  const int exponent = exact::detail::grid_of(c, c + 9).exponent;
  const exact::detail::Triangles<Numbers> t = exact::detail::triangles<Numbers>(c, c + 9, exponent);
  const Relation r = by_axes(t);
  settle(block, i, r, bit(block.wrong, i) ? exact::detail::nesting(t, r) : Nesting::none);
}

template <class Numbers>
struct RelateByAxes {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    relate_by_axes<Numbers>(block, i, c);
  }
};

struct SettleDepth {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    block.buckets[i] = bucket_by_bounds<double>(c, Verdict::intersects);
    if (block.buckets[i] == kUndecided) block.lists[kCloseDepths].add(i);
  }
};

// The last attempt, in double-double numbers. Pairs that remain undecided are left to the host.
template <Verdict verdict>
struct MeasureClosely {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    block.buckets[i] = bucket_by_bounds<DoubleDouble>(c, verdict);
    if (block.buckets[i] == kUndecided) leave_to_host(block, i);
  }
};

// Finds the extreme of a pair whose bucket is known.
struct PlaceExtreme {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const EngineBlock& block, std::uint32_t i, const float* c) const {
    block.extremes[i] = block.buckets[i] == kUndecided ? kUndecided : place_on_axis(pair_of(c), block.axis);
  }
};

// The steps for blocks of doubles. Single precision measures wide margins on the pair rounded to float32; double-double
// bounds measure other margins. If these bounds do not decide the bucket, or if the relation needs more bits than
// RelatingDoubles has, the pair is left to the host.
using RelatingDoubles = exact::detail::LongNumbers;

struct FindChanged {
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t word) const {
    block.changed[word] = (block.stored.intersects[word] ^ block.truth[word]) | block.stored.declined[word];
  }
};

GRAZE_HD inline ScaledPair scaled_pair(const DoubleEngineBlock& block, std::uint32_t i) {
  double c[kCoordinates];
  load(block.doubles, i, c);
  return ScaledPair(pair_of(c));
}

GRAZE_HD inline void give_up(const EngineBlock& block, std::uint32_t i) {
  block.buckets[i] = kUndecided;
  leave_to_host(block, i);
}

struct MeasureStored {
  static constexpr int kThreadBlocks = 2;
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t i, const float* stored) const {
    Bucket bucket;
    const Verdict verdict = bit(block.truth, i) ? Verdict::intersects : Verdict::disjoint;
    const bool measured = !bit(block.changed, i) && bucket_by_single(pair_of(stored), verdict, bucket);
    bucket = measured ? wide_bucket(bucket, kUndecided) : kUndecided;
    block.buckets[i] = bucket;
    if (bucket == kUndecided) {
      block.lists[verdict == Verdict::intersects ? kOpenDepths : kOpenGaps].add(i);
    } else if (bit(block.wrong, i)) {
      block.lists[kRelated].add(i);
    }
  }
};

template <Verdict verdict>
struct MeasureDoubles {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t i, const float*) const {
    const ScaledPair scaled = scaled_pair(block, i);
    if (!scaled.fits) return leave_to_host(block, i);
    const MarginBounds bounds = margin_bounds<DoubleDouble>(scaled.pair, verdict);
    Bucket bucket;
    if constexpr (verdict == Verdict::disjoint) {
      bucket = bucket_within(&scaled.pair.a[0].x, bounds, verdict, scaled.ulp);
      if (bucket == kUndecided) return leave_to_host(block, i);
    } else if (!bucket_from_bounds(bounds, verdict, scaled.ulp, bucket)) {
      bucket = kUndecided;  // the margin may be zero
    }
    block.buckets[i] = bucket;
    if (bucket == kUndecided || bit(block.wrong, i)) block.lists[kRelated].add(i);
  }
};

struct RelateDoubles {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t i, const float*) const {
    using namespace exact::detail;
    const ScaledPair scaled = scaled_pair(block, i);
    if (!scaled.fits) return give_up(block, i);
    const double *a = &scaled.pair.a[0].x, *b = &scaled.pair.b[0].x;
    Relation r;
    Nesting nesting;
    if ((relate_quickly(a, b, r) || relate_by_bounds(a, b, r)) && nest_quickly(block, i, a, r, nesting))
      return settle(block, i, r, nesting);
    RelatingDoubles::holds(grid_of(a, b)) ? block.lists[kByLong].add(i) : give_up(block, i);
  }
};

struct RelateDoublesByAxes {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t i, const float*) const {
    const ScaledPair scaled = scaled_pair(block, i);
    relate_by_axes<RelatingDoubles>(block, i, &scaled.pair.a[0].x);
  }
};

struct SettleDoubleDepth {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t i, const float*) const {
    const ScaledPair scaled = scaled_pair(block, i);
    const MarginBounds bounds = margin_bounds<DoubleDouble>(scaled.pair, Verdict::intersects);
    block.buckets[i] = bucket_within(&scaled.pair.a[0].x, bounds, Verdict::intersects, scaled.ulp);
    if (block.buckets[i] == kUndecided) leave_to_host(block, i);
  }
};

struct PlaceExtremeOfDoubles {
  static constexpr int kThreadBlocks = 1;
  GRAZE_HD void operator()(const DoubleEngineBlock& block, std::uint32_t i, const float*) const {
    double c[kCoordinates];
    load(block.doubles, i, c);
    block.extremes[i] = block.buckets[i] == kUndecided ? kUndecided : place_on_axis(pair_of(c), block.axis);
  }
};

// Calls add(counter, pairs) for each counter of the pairs and of lanes [from, to). `pairs` has the bits of the pairs in
// the word that add to the counter. same: the pairs to count, all in the same bucket. Counters are in the order of
// EngineResult and start with lane `from`.
template <class Block, class Add>
GRAZE_HD void count_word(const Block& block, std::uint32_t word, std::uint32_t same, std::uint32_t from,
                         std::uint32_t to, const Add& add) {
  const std::uint32_t truth = block.truth[word];
  add(0, same);
  add(1, same & truth);
  for (std::uint32_t l = from; l < to; ++l) {
    const LaneWords& lane = block.lanes.lanes[l];
    const JudgedBits<std::uint32_t> bits = judge(lane.intersects[word], lane.declined[word], truth, same);
    const std::uint32_t counter = kCountersOfPairs + Block::kCountersOfLane * (l - from);
    add(counter, bits.false_positive);
    add(counter + 1, bits.false_negative);
    add(counter + 2, bits.declined);
    if constexpr (std::is_same_v<Block, DoubleEngineBlock>) {
      const std::uint32_t* changed = block.changed_for_lane[l];
      add(counter + 3, changed ? bits.wrong() & changed[word] : 0);
    }
  }
}

// Runs all steps in order. The type Run has these members:
// - words(step) runs a step on the block's words, pairs(step) on its pairs, listed(step, list) on listed pairs;
// - pairs_by_verdict(step) runs a step on the block's pairs, sorted by verdict if possible;
// - add_signatures(list) adds the signatures of the listed pairs; tally(by_extreme) counts pairs by bucket or by
// extreme.
template <class Run>
void run_steps(const EngineBlock& block, const Run& run) {
  using namespace exact::detail;
  run.words(MarkWrong{});
  run.pairs_by_verdict(MeasureBySingle{});
  run.listed(MeasureByDouble<Verdict::disjoint>{}, kOpenGaps);
  run.listed(MeasureByDouble<Verdict::intersects>{}, kOpenDepths);
  run.listed(BreakTie{}, kTies);
  run.listed(MeasureClosely<Verdict::disjoint>{}, kCloseTies);
  run.listed(Relate{}, kRelated);
  run.listed(RelateByBounds{}, kByBounds);
  run.listed(RelateByAxes<DoubleNumbers>{}, kByDoubles);
  run.listed(RelateByAxes<ResidueNumbers>{}, kByResidues);
  run.listed(RelateByAxes<IntNumbers>{}, kByInts);
  run.listed(RelateByAxes<LongNumbers>{}, kByLong);
  run.listed(RelateByAxes<WideNumbers>{}, kByWide);
  run.listed(SettleDepth{}, kDepths);
  run.listed(MeasureClosely<Verdict::intersects>{}, kCloseDepths);
  run.add_signatures(kRelated);
  run.tally(false);
  if (block.axis == Axis::none) return;
  run.pairs(PlaceExtreme{});
  run.tally(true);
}

template <class Run>
void run_steps(const DoubleEngineBlock& block, const Run& run) {
  run.words(MarkWrong{});
  run.words(FindChanged{});
  run.pairs_by_verdict(MeasureStored{});
  run.listed(MeasureDoubles<Verdict::disjoint>{}, kOpenGaps);
  run.listed(MeasureDoubles<Verdict::intersects>{}, kOpenDepths);
  run.listed(RelateDoubles{}, kRelated);
  run.listed(RelateDoublesByAxes{}, kByLong);
  run.listed(SettleDoubleDepth{}, kDepths);
  run.add_signatures(kRelated);
  run.tally(false);
  if (block.axis == Axis::none) return;
  run.pairs(PlaceExtremeOfDoubles{});
  run.tally(true);
}

}  // namespace GRAZE_FP
}  // namespace graze::cuda
