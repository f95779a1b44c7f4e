// SPDX-License-Identifier: Apache-2.0
// A subject's convention excludes some kinds of pairs, on which the subject's verdicts are neither right nor wrong.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "oracle/truth.h"

namespace graze::analysis {

// Whether the verdict differs from the truth and the lane's convention excludes the pair. Crashes, time-outs and
// unstable verdicts are never excused.
template <class Real>
bool by_convention(const Lane& lane, Verdict verdict, const BasicPair<Real>& pair, const Relation& truth);
inline bool by_convention(const Lane& lane, Verdict verdict, const AnyPair& pair, const Relation& truth) {
  return visit(pair, [&](const auto& own) { return by_convention(lane, verdict, own, truth); });
}

// Replaces verdicts that differ by convention with the truth. Returned verdicts that differ from the truth are wrong or
// declined.
std::vector<Verdict> excused(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts, const AnyPair& pair,
                             const Relation& truth);

// "touching pairs, coplanar pairs"; empty for a convention that excludes nothing.
std::string outside_in_words(unsigned outside);

}  // namespace graze::analysis
