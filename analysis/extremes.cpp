// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/wilson.h"

namespace graze::analysis {
namespace {

struct Limits {
  double least, most;  // bounds on the share of errors up to which the lane is as right as at the origin
};

Limits limits_of(const ErrorsAt& origin) {
  const Share share = share_of(origin.errors, origin.pairs);
  return {std::max(kAsRight * share.low, kRightShare), std::max(kAsRight * share.high, kRightShare)};
}

bool is_right(const ErrorsAt& at, const Limits& limits) { return share_of(at.errors, at.pairs).high <= limits.least; }

// points: ordered from the origin outwards.
template <class Points>
RightSide side_of(const Points& points, const Limits& limits) {
  RightSide side{points.front().exponent, points.back().exponent, {}};
  bool right = true;
  for (const ErrorsAt& at : points) {
    right = right && is_right(at, limits);
    if (right) side.right = at.exponent;
    if (!side.worse && share_of(at.errors, at.pairs).low > limits.most) side.worse = at.exponent;
  }
  return side;
}

}  // namespace

std::optional<RightRange> right_range(std::span<const ErrorsAt> points) {
  std::vector<ErrorsAt> enough;
  std::copy_if(points.begin(), points.end(), std::back_inserter(enough),
               [](const ErrorsAt& at) { return at.pairs >= kFewPairs; });
  if (enough.empty()) return std::nullopt;
  const auto origin = std::min_element(enough.begin(), enough.end(), [](const ErrorsAt& l, const ErrorsAt& r) {
    return std::abs(l.exponent) < std::abs(r.exponent);
  });
  const Limits limits = limits_of(*origin);
  RightRange range{*origin, is_right(*origin, limits),
                   side_of(std::vector(std::make_reverse_iterator(origin + 1), enough.rend()), limits),
                   side_of(std::vector(origin, enough.end()), limits)};
  for (const ErrorsAt& at : points) {  // including points with too few pairs to show anything
    if (at.pairs == 0) continue;
    range.down.last = std::min(range.down.last, at.exponent);
    range.up.last = std::max(range.up.last, at.exponent);
  }
  return range;
}

}  // namespace graze::analysis
