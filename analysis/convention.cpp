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

bool by_convention(const Lane& lane, Verdict verdict, const Pair& pair, Contact contact, const oracle::Shape& shape,
                   bool touches) {
  if (lane.outside == 0 || is_failure(verdict)) return false;
  return (lane.outside & kOutsideTouching && touches && contact != Contact::area) ||
         (lane.outside & kOutsideCoplanar && shape.coplanar) ||
         (lane.outside & kOutsideDegenerate && (shape.dimension_a < 2 || shape.dimension_b < 2)) ||
         (lane.outside & kOutsideShared && share_a_vertex(pair));
}

bool by_convention(const Lane& lane, Verdict verdict, const Pair& pair, const oracle::Truth& truth) {
  if (lane.outside == 0 || truth.verdict == Verdict::declined || verdict == truth.verdict) return false;
  return by_convention(lane, verdict, pair, truth.contact, oracle::shape(pair),
                       truth.verdict == Verdict::intersects && truth.margin == 0);
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
