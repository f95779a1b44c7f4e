// SPDX-License-Identifier: Apache-2.0
// Signatures: the bucket key of an algorithm's failure. Pairs with one signature fail alike.
#pragma once

#include <span>
#include <string>

#include "analysis/tally.h"
#include "core/lanes.h"
#include "core/verdict.h"
#include "oracle/truth.h"

namespace graze {

// How a lane's answer compares with the truth: '.' right, '+' false positive, '-' false negative, '?' declined.
char mark(Verdict lane, Verdict truth);

// "point/22/skew/-2^-3/moller_1997:+-__..__": contact, dimensions, coplanar or skew, margin bucket, and the algorithm
// with its lanes' marks, f32 then f64, each in the order of Target; '_' for a lane that did not run.
// One algorithm a signature: a pair on which several fail belongs to one signature of each.
// Requires: lanes are of one algorithm, verdicts theirs.   Returns: the key; empty when no lane is wrong.
std::string signature(Contact contact, const Shape& shape, Bucket bucket, Verdict truth, std::span<const Lane* const> lanes,
                      std::span<const Verdict> verdicts);

// Calls visit(first, count) for each run of lanes of one algorithm. Requires: lanes in table order.
template <class Visit>
void for_each_algorithm(std::span<const Lane* const> lanes, Visit visit) {
  for (std::size_t first = 0, end; first < lanes.size(); first = end) {
    for (end = first; end < lanes.size() && lanes[end]->algorithm == lanes[first]->algorithm;) ++end;
    visit(first, end - first);
  }
}

}  // namespace graze
