// SPDX-License-Identifier: Apache-2.0
// The truth of a pair: exact for every finite float32 pair, subnormals and 1e38 included.
#pragma once

#include <compare>
#include <stdexcept>

#include "core/margin/bucket.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze::oracle {

struct Truth : Relation {
  double margin = 0;       // signed gap in the pair's units, correctly rounded; NaN when declined
  double margin_ulps = 0;  // the same in float32 ulps of the largest coordinate
};

// The oracle's two decisions differ: a defect in the oracle itself.
struct OracleMismatch : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Relation and margin; the verdict is CGAL's, confirmed by the decision on GMP integers.
// Exact: always; the margin is a rational's square root, rounded once by MPFR.
// Throws: OracleMismatch.   Returns: declined, unknown, NaN where a coordinate is not finite.
Truth truth(const Pair& pair);

// CGAL's decision: closed triangles by its triangle test, degenerate ones as segments and points.
// Requires: finite coordinates.   Exact: always.
Verdict cgal_verdict(const Pair& pair);

// The independent decision: the dimension of the common set from signs of determinants of GMP integers.
// Requires: finite coordinates.   Exact: always.   The pair intersects when this is not Contact::none.
Contact gmp_contact(const Pair& pair);

// By exact ranks of integer vectors.   Requires: finite coordinates.   Exact: always.
Hulls hulls(const Pair& pair);

// Bucket of the exact margin. A certified double-precision estimate decides nearly always, GMP otherwise.
// Requires: finite coordinates; verdict is the pair's true verdict.   Exact: always.
Bucket margin_bucket(const Pair& pair, Verdict verdict);

}  // namespace graze::oracle
