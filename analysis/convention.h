// SPDX-License-Identifier: Apache-2.0
// What a foreign subject's convention leaves open: its verdicts there are neither errors nor right.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "oracle/truth.h"

namespace graze::analysis {

// Whether a verdict that is not the truth is of a pair that the lane's convention leaves open. A crash, an endless
// loop and a verdict that changes are never a convention.
bool by_convention(const Lane& lane, Verdict verdict, const Pair& pair, const Relation& truth);

// Whether the lane's convention leaves the pair open.   Requires: finite coordinates.
bool is_outside(const Lane& lane, const Pair& pair, const Relation& truth);

// The lanes' verdicts, with the truth in place of those that are by convention: what counts as wrong is left.
std::vector<Verdict> excused(std::span<const Lane* const> lanes, std::vector<Verdict> verdicts, const Pair& pair,
                             const oracle::Truth& truth);

// "touching pairs, coplanar pairs"; empty for a convention that leaves nothing open.
std::string outside_in_words(unsigned outside);

}  // namespace graze::analysis
