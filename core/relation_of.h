// SPDX-License-Identifier: Apache-2.0
// The exact decision (core/exact/exact.h) for a pair.
#pragma once

#include "core/exact/exact.h"
#include "core/pair.h"

namespace graze {

// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline Relation relation_of(const Pair& pair) { return exact::relation(&pair.a[0].x, &pair.b[0].x); }
GRAZE_HD inline Relation relation_of(const DoublePair& pair) { return exact::relation(&pair.a[0].x, &pair.b[0].x); }

// Like relation_of, but declined if a coordinate is not finite.
template <class Real>
Relation relation_or_declined(const BasicPair<Real>& pair) {
  return is_finite(pair) ? relation_of(pair) : Relation{Verdict::declined, Contact::unknown, 0, {}};
}

}  // namespace graze
