// SPDX-License-Identifier: Apache-2.0
// Signatures: the bucket key of an algorithm's failure. Pairs with one signature fail alike.
#pragma once

#include <array>
#include <compare>
#include <span>
#include <string>

#include "analysis/tally.h"
#include "core/lanes.h"
#include "core/verdict.h"
#include "oracle/truth.h"

namespace graze::analysis {

// How a lane's answer compares with the truth: '.' right, '+' false positive, '-' false negative, '?' declined.
char mark(Verdict lane, Verdict truth);

// One algorithm's failure on a pair. One algorithm a signature: a pair on which several fail has several.
struct Signature {
  Contact contact = Contact::none;
  oracle::Shape shape;
  Bucket bucket = 0;
  int algorithm = 0;
  std::array<char, 2 * kTargetCount> marks{};  // f32, then f64, each in the order of Target; '_': did not run

  bool wrong() const;  // whether any lane is
  auto operator<=>(const Signature&) const = default;
};

// Requires: lanes are of one algorithm, verdicts theirs.
Signature signature(Contact contact, const oracle::Shape& shape, Bucket bucket, Verdict truth,
                    std::span<const Lane* const> lanes, std::span<const Verdict> verdicts);

// "point/22/skew/-2^-3/moller_1997:+-__..__": contact, dimensions, coplanar or skew, margin bucket, algorithm, marks.
std::string key(const Signature& signature);

// "moller_1997" of such a key.
std::string algorithm_of(const std::string& key);

// Calls visit(first, count) for each run of lanes of one algorithm, but for the exact lanes, which have no failures.
// Requires: lanes in table order.
template <class Visit>
void for_each_algorithm(std::span<const Lane* const> lanes, Visit visit) {
  for (std::size_t first = 0, end; first < lanes.size(); first = end) {
    for (end = first; end < lanes.size() && lanes[end]->algorithm == lanes[first]->algorithm;) ++end;
    if (!lanes[first]->is_exact()) visit(first, end - first);
  }
}

}  // namespace graze::analysis
