// SPDX-License-Identifier: Apache-2.0
#include "analysis/convention.h"

namespace graze::analysis {
namespace {

bool share_a_vertex(const Pair& pair) {
  for (const Vec3<float>& a : pair.a) {
    for (const Vec3<float>& b : pair.b) {
      if (a.x == b.x && a.y == b.y && a.z == b.z) return true;
    }
  }
  return false;
}

}  // namespace

bool is_outside(const Lane& lane, const Pair& pair, const Relation& truth) {
  const Hulls& hulls = truth.hulls;
  return (lane.outside & kOutsideTouching && truth.touches() && truth.contact != Contact::area) ||
         (lane.outside & kOutsideCoplanar && hulls.coplanar) ||
         (lane.outside & kOutsideDegenerate && (hulls.dimension_a < 2 || hulls.dimension_b < 2)) ||
         (lane.outside & kOutsideShared && share_a_vertex(pair));
}

bool by_convention(const Lane& lane, Verdict verdict, const Pair& pair, const Relation& truth) {
  if (is_failure(verdict) || truth.verdict == Verdict::declined || verdict == truth.verdict) return false;
  return is_outside(lane, pair, truth);
}

std::vector<Verdict> excused(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts, const Pair& pair,
                             const oracle::Truth& truth) {
  for (std::size_t l = 0; l < verdicts.size(); ++l) {
    if (by_convention(*lanes[l], verdicts[l], pair, truth)) verdicts[l] = truth.verdict;
  }
  return verdicts;
}

std::string outside_in_words(unsigned outside) {
  std::string words;
  const auto add = [&](unsigned bit, const char* what) {
    if (outside & bit) words += (words.empty() ? "" : ", ") + std::string(what);
  };
  add(kOutsideTouching, "touching pairs");
  add(kOutsideCoplanar, "coplanar pairs");
  add(kOutsideDegenerate, "degenerate triangles");
  add(kOutsideShared, "pairs that share a vertex");
  return words;
}

}  // namespace graze::analysis
