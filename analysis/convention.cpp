// SPDX-License-Identifier: Apache-2.0
#include "analysis/convention.h"

#include "core/lanes/convention.h"

namespace graze::analysis {
namespace {

template <class AnyPair>
bool differs_by_convention(const Lane& lane, Verdict verdict, const AnyPair& pair, const Relation& truth) {
  if (is_failure(verdict) || truth.verdict == Verdict::declined || verdict == truth.verdict) return false;
  return graze::is_outside(lane.outside, pair, truth);
}

template <class AnyPair>
std::vector<Verdict> with_truth_by_convention(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts,
                                              const AnyPair& pair, const oracle::Truth& truth) {
  for (std::size_t l = 0; l < verdicts.size(); ++l) {
    if (differs_by_convention(*lanes[l], verdicts[l], pair, truth)) verdicts[l] = truth.verdict;
  }
  return verdicts;
}

}  // namespace

bool is_outside(const Lane& lane, const Pair& pair, const Relation& truth) {
  return graze::is_outside(lane.outside, pair, truth);
}

bool by_convention(const Lane& lane, Verdict verdict, const Pair& pair, const Relation& truth) {
  return differs_by_convention(lane, verdict, pair, truth);
}

bool by_convention(const Lane& lane, Verdict verdict, const DoublePair& pair, const Relation& truth) {
  return differs_by_convention(lane, verdict, pair, truth);
}

std::vector<Verdict> excused(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts, const Pair& pair,
                             const oracle::Truth& truth) {
  return with_truth_by_convention(lanes, std::move(verdicts), pair, truth);
}

std::vector<Verdict> excused(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts, const DoublePair& pair,
                             const oracle::Truth& truth) {
  return with_truth_by_convention(lanes, std::move(verdicts), pair, truth);
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
