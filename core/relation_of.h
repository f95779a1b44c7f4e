// SPDX-License-Identifier: Apache-2.0
// The exact decision (core/exact/exact.h) of a pair.
#pragma once

#include "core/exact/exact.h"
#include "core/pair.h"

namespace graze {

// Requires: finite coordinates. Exact for every such pair.
GRAZE_HD inline Relation relation_of(const Pair& pair) { return exact::relation(&pair.a[0].x, &pair.b[0].x); }
GRAZE_HD inline Relation relation_of(const DoublePair& pair) { return exact::relation(&pair.a[0].x, &pair.b[0].x); }

}  // namespace graze
