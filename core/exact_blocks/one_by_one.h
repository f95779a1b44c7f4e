// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/decide_each.h"
#include "core/exact/exact.h"

namespace graze::exact {

// Like decide (decide.h), but one pair at a time.
template <class Real>
void one_by_one(const Real* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  using AnyPair = BasicPair<Real>;
  decide_each(reinterpret_cast<const AnyPair*>(pairs), count, intersects, declined, [](const AnyPair& pair) {
    return !is_finite(pair)                                ? Verdict::declined
           : exact::intersects(&pair.a[0].x, &pair.b[0].x) ? Verdict::intersects
                                                           : Verdict::disjoint;
  });
}

}  // namespace graze::exact
