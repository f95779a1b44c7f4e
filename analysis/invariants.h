// SPDX-License-Identifier: Apache-2.0
// Counts how often a lane's verdict changes although it should not, and lists the invariants that each algorithm
// claims.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "analysis/sweep.h"

namespace graze::analysis {

enum class Invariant : std::uint8_t { swap, order, mirror, axes, scale, translate, part };

struct InvariantInfo {
  Invariant invariant;
  std::string_view id;
  std::string_view what;  // the images of a pair, in words
};

// In the order of the enumeration. Only the images of `part` may have another truth: a triangle that intersects a part
// of another intersects the whole.
inline constexpr InvariantInfo kInvariants[] = {
    {Invariant::swap, "swap", "the two triangles swapped"},
    {Invariant::order, "order", "the other 35 orders of the vertices within both triangles"},
    {Invariant::mirror, "mirror", "the 7 mirror images in planes through the origin and across the axes"},
    {Invariant::axes, "axes", "the 5 other orders of the axes"},
    {Invariant::scale, "scale", "times 2^k for k of 1, 4, 16 and 64, up and down, where no bit is lost"},  // kScales
    {Invariant::translate, "translate",
     "each vertex moved to the origin, and all coordinates scaled by a power of two, where no bit is lost"},
    {Invariant::part, "part", "one triangle replaced by one of its four parts, the edges halved, where no bit is lost"},
};
inline constexpr std::size_t kInvariantCount = std::size(kInvariants);

// The images of `scale` are the pair times 2^k, for each of these k.
inline constexpr std::array kScales = {1, -1, 4, -4, 16, -16, 64, -64};

// The pair's images, without the pair itself. Images that would lose bits are left out.
template <class Real>
std::vector<BasicPair<Real>> images(Invariant invariant, const BasicPair<Real>& pair);

// Whether these verdicts on a pair and its image break the invariant.
bool breaks(Invariant invariant, Verdict of_pair, Verdict of_image);

// Whether the lane's algorithm claims the invariant: it is written so that rounding cannot break the invariant. Claims
// apply to lanes without a policy that round each operation as written, and only if nothing overflows or underflows on
// the pair or its image. invariants.test.cpp checks the claims.
bool claims(const Lane& lane, Invariant invariant);

// Whether InvariantCount::in_range can be computed for the lane.
bool knows_range(const Lane& lane);

// The invariants that a published algorithm claims; invariants.cpp gives the reason for each.
std::vector<Invariant> claimed_invariants(std::string_view algorithm);

// An invariant was broken by the exact decision, by the oracle, or by an algorithm that claims it.
struct InvariantBroken : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct InvariantCount {
  std::uint64_t pairs = 0;    // pairs with an image, except those that the lane's convention excludes
  std::uint64_t changed = 0;  // pairs on which the verdict on some image breaks the invariant
  // How many of the changed pairs, each with an image that breaks the invariant, have no overflow or underflow when the
  // lane's source runs without contraction. Known for published lanes without a policy; 0 for others.
  std::uint64_t in_range = 0;
  InvariantCount& operator+=(const InvariantCount& other);
};

struct InvariantCase {
  PairPlace place;
  AnyPair pair, image;
  Verdict of_pair = Verdict::declined, of_image = Verdict::declined;
};

struct InvariantsOfLane {
  std::array<std::vector<InvariantCount>, kInvariantCount> counts;  // by invariant, then by source
  std::array<std::optional<InvariantCase>, kInvariantCount> simplest;
  // For each of kScales, over all sources: the number of pairs with this image, and of those whose verdict it changes.
  std::array<InvariantCount, kScales.size()> by_scale;

  InvariantCount total(Invariant invariant) const;
};

// CGAL's verdict, which must equal GMP's.   Throws: InvariantBroken.
bool oracle_intersects(const AnyPair& pair);

struct InvariantSpec {
  std::vector<const Lane*> lanes;
  std::vector<DecideBlock> on_host;         // for each lane: the host lane or its twin
  std::vector<strata::PairSource> sources;  // lanes in float decide pairs of doubles as float32 stores them
  int threads = 0;                          // 0: one on each core
  // Whether l is simpler than r. The simplest case is kept, or the first of equally simple ones.
  std::function<bool(const AnyPair& l, const AnyPair& r)> simpler;
  DecideBlock exact = find_lane("exact/f64/cpu")->decide;              // decides every image
  std::function<bool(const AnyPair&)> intersects = oracle_intersects;  // decides all images of some pairs
  std::uint64_t oracle_every = 8;                                      // the oracle decides one pair in this many
};

struct Invariants {
  std::vector<InvariantsOfLane> lanes;
  // Pairs and images that the exact decision decides. A pair of doubles and the pair that float32 stores count as two.
  std::uint64_t pairs = 0, images = 0;
  std::uint64_t by_oracle = 0, its_images = 0;  // pairs, and their images, that CGAL and GMP decide too
};

// Runs every lane on every pair and all its images. The result does not depend on the number of threads.
// Throws: InvariantBroken for the first pair on which an invariant that must hold is broken.
Invariants invariants(const InvariantSpec& spec);

}  // namespace graze::analysis
