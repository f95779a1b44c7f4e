// SPDX-License-Identifier: Apache-2.0
// The truth of a pair, exact for every pair with finite float32 or double coordinates, from subnormals to 1e308.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/any_pair.h"
#include "core/margin/bucket.h"
#include "core/verdict.h"

namespace graze::oracle {

struct Truth : Relation {
  double margin = 0;       // signed gap in the pair's units, correctly rounded; NaN when declined
  double margin_ulps = 0;  // the same in ulps of the largest coordinate, in the pair's type
};

// Thrown if the oracle's two decisions differ, which is a defect in the oracle itself.
struct OracleMismatch : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Relation and margin. The verdict is CGAL's, confirmed by the decision on GMP integers.
// Exact: always; the margin is a rational's square root, rounded once by MPFR. If the margin of a pair of doubles is
// beyond the range of double, the least or the largest positive double is returned.
// Throws: OracleMismatch.   Returns: declined, unknown and NaN if a coordinate is not finite.
Truth truth(const Pair& pair);
Truth truth(const DoublePair& pair);
inline Truth truth(const AnyPair& pair) {
  return visit(pair, [](const auto& own) { return oracle::truth(own); });
}

// For messages: the 18 coordinates as hex floats, each after a space.
std::string hex(const DoublePair& pair);
inline std::string hex(const Pair& pair) { return hex(in_doubles(pair)); }

// A margin's size in words: "0.25", "less than 1e-323", "at least 1.79e308".
std::string margin_words(double size);

// CGAL's decision: its triangle test for proper triangles, and its tests of segments and points for degenerate ones.
// Requires: finite coordinates.   Exact: always.
Verdict cgal_verdict(const DoublePair& pair);
inline Verdict cgal_verdict(const Pair& pair) { return cgal_verdict(in_doubles(pair)); }

// The independent decision: the dimension of the common set, from signs of determinants of GMP integers.
// Requires: finite coordinates.   Exact: always. The pair intersects if this is not Contact::none.
Contact gmp_contact(const DoublePair& pair);
inline Contact gmp_contact(const Pair& pair) { return gmp_contact(in_doubles(pair)); }

// The hulls, from exact ranks of integer vectors.   Requires: finite coordinates.   Exact: always.
Hulls hulls(const DoublePair& pair);
inline Hulls hulls(const Pair& pair) { return hulls(in_doubles(pair)); }

// The bucket of the exact margin, nearly always decided by a certified double-precision estimate, and otherwise by GMP.
// Requires: finite coordinates; verdict is the pair's true verdict.   Exact: always.
Bucket margin_bucket(const Pair& pair, Verdict verdict);
// The same bucket for doubles: in double-precision ulps of the largest coordinate.
Bucket margin_bucket(const DoublePair& pair, Verdict verdict);

// Indices of the pair's numbers that float32 cannot hold as written. Float32 can hold infinities and NaN.
// Requires: 18 texts; `stored` has their nearest float32 values (core/text.h).
// Throws: std::runtime_error for an exponent of more than five digits.
std::vector<std::size_t> rounded(std::span<const std::string> numbers, const Pair& stored);

// Verdict, contact and margin of the numbers as they were typed, as rationals, decided like truth(). Ulps are those of
// the stored pair.
// Returns: nothing if every number is stored as written, or if a number is not finite.
// Exact: always.   Throws: OracleMismatch; the errors of rounded.
std::optional<Truth> truth_as_written(std::span<const std::string> numbers, const Pair& stored);

// For drawings: the extreme points of the two closed hulls' common set, which are none, one, two, or a convex polygon's
// vertices in order. Constructed exactly with rationals, and rounded at the end.
// Requires: finite coordinates.   Exact: except for the rounding to double.
std::vector<Vec3<double>> common_set(const AnyPair& pair);

// The line where the triangles' planes meet: the two ends of its part within the pair's box, enlarged by a tenth on
// each side. No points if a triangle is flat, the planes are parallel, or the line misses the box.
// Requires: finite coordinates.   Exact: like common_set.
std::vector<Vec3<double>> planes_line(const AnyPair& pair);

}  // namespace graze::oracle
