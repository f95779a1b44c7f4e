// SPDX-License-Identifier: Apache-2.0
#include "analysis/convention.h"

#include "core/lanes/convention.h"

namespace graze::analysis {
template <class Real>
bool by_convention(const Lane& lane, Verdict verdict, const BasicPair<Real>& pair, const Relation& truth) {
  if (is_failure(verdict) || truth.verdict == Verdict::declined || verdict == truth.verdict) return false;
  return is_outside(lane.outside, pair, truth);
}

template bool by_convention(const Lane&, Verdict, const Pair&, const Relation&);
template bool by_convention(const Lane&, Verdict, const DoublePair&, const Relation&);

std::vector<Verdict> excused(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts, const AnyPair& pair,
                             const Relation& truth) {
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
