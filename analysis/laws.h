// SPDX-License-Identifier: Apache-2.0
// Laws: how often a lane's verdict changes although the question is the same, and which laws an algorithm claims.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/sweep.h"

namespace graze::analysis {

enum class Law : std::uint8_t { swap, order, mirror, axes, scale, translate, part };

struct LawInfo {
  Law law;
  std::string_view id;
  std::string_view what;  // the images of a pair, in words
};

// In the order of the enumeration. The images of `part` alone have another truth: what intersects a part of a triangle
// intersects the triangle.
inline constexpr LawInfo kLaws[] = {
    {Law::swap, "swap", "the two triangles swapped"},
    {Law::order, "order", "the other 35 orders of the vertices within both triangles"},
    {Law::mirror, "mirror", "the 7 mirror images in planes through the origin and across the axes"},
    {Law::axes, "axes", "the 5 other orders of the axes"},
    {Law::scale, "scale", "times 2^k for k of 1, 4, 16 and 64, up and down, where no bit is lost"},  // kScales
    {Law::translate, "translate", "each vertex moved to the origin, and all by a power of two, where no bit is lost"},
    {Law::part, "part", "one triangle replaced by one of its four parts, the edges halved, where no bit is lost"},
};
inline constexpr std::size_t kLawCount = std::size(kLaws);

// The powers of two of the images of `scale`.
inline constexpr std::array kScales = {1, -1, 4, -4, 16, -16, 64, -64};

// The pair's images, without the pair itself; none where all of them would lose bits.
std::vector<Pair> images(Law law, const Pair& pair);

// Whether these verdicts on a pair and its image break the law.
bool breaks(Law law, Verdict of_pair, Verdict of_image);

// Whether the lane's algorithm claims the law: no rounding can break it, by how the code is written. A claim is one of
// arithmetic that rounds each operation as written, without a policy, and of pairs on which neither the lane's
// computation of the pair nor that of the image over- or underflows. laws.test.cpp holds lanes to it.
bool claims(const Lane& lane, Law law);

// Whether LawCount::in_range is known of the lane.
bool knows_range(const Lane& lane);

// Of all published algorithms, by name: the reason stands beside each claim in laws.cpp.
std::vector<Law> claimed_laws(std::string_view algorithm);

// A law that the exact decision or the oracle breaks, or an algorithm that claims it.
struct LawBroken : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct LawCount {
  std::uint64_t pairs = 0;    // that have an image, and that the lane's convention does not leave open
  std::uint64_t changed = 0;  // on which the verdict on some image breaks the law
  // Of these, those on which one does although nothing over- or underflows, neither of the pair nor of that image,
  // where the lane's source runs without contraction. Of published lanes without a policy; else 0, for it is not known.
  std::uint64_t in_range = 0;
  LawCount& operator+=(const LawCount& other);
};

struct LawCase {
  PairPlace place;
  Pair pair, image;
  Verdict of_pair = Verdict::declined, of_image = Verdict::declined;
};

struct LawsOfLane {
  std::array<std::vector<LawCount>, kLawCount> counts;  // by law, then by source
  std::array<std::optional<LawCase>, kLawCount> simplest;
  // Over all sources, by each of kScales alone: the pairs that have this image, and on which it breaks the law.
  std::array<LawCount, kScales.size()> by_scale;

  LawCount total(Law law) const;
};

// CGAL's verdict, which GMP's must be.   Throws: LawBroken.
bool oracle_intersects(const Pair& pair);

struct LawSpec {
  std::vector<const Lane*> lanes;
  std::vector<DecideBlock> on_host;  // of each: the host lane or its twin
  std::vector<strata::PairSource> sources;
  int threads = 0;  // 0: one on each core
  // Whether l is simpler than r, for the case that is kept; equal ones are kept by their place.
  std::function<bool(const Pair& l, const Pair& r)> simpler;
  DecideBlock exact = find_lane("exact/f32/cpu")->decide;           // asked of every image
  std::function<bool(const Pair&)> intersects = oracle_intersects;  // asked of every image of some pairs:
  std::uint64_t oracle_every = 8;                                   // of the first of so many
};

struct Laws {
  std::vector<LawsOfLane> lanes;
  std::uint64_t pairs = 0, images = 0;          // all of them decided by the exact decision
  std::uint64_t by_oracle = 0, its_images = 0;  // and these by CGAL and GMP
};

// Asks every lane of every pair and of all its images. The same whatever the threads.
// Throws: LawBroken, of the first pair that shows it.
Laws laws(const LawSpec& spec);

}  // namespace graze::analysis
