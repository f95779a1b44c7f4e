// SPDX-License-Identifier: Apache-2.0
// Computes exact squares of distances and depths; see exact_margin.h.
#include "oracle/exact_margin.h"

#include <mpfr.h>

#include <algorithm>
#include <limits>

namespace graze::oracle {
namespace {

using Int = mpz_class;
using Vector = Vec3<mpz_class>;

// Keeps the lesser of two rationals. An unset margin (denominator 0) counts as greater than any rational.
void keep_least(SquaredMargin& least, const Int& numerator, const Int& denominator) {
  if (least.denominator != 0 && numerator * least.denominator >= least.numerator * denominator) return;
  least.numerator = numerator;
  least.denominator = denominator;
}

void vertex_and_vertex(SquaredMargin& least, const Vector& p, const Vector& q) {
  const Vector between = q - p;
  keep_least(least, dot(between, between), 1);
}

// The distance of a vertex from an edge, which counts only if the foot of the perpendicular lies on the edge.
void vertex_and_edge(SquaredMargin& least, const Vector& p, const Vector& start, const Vector& edge) {
  const Vector at = p - start;
  const Int along = dot(at, edge), length2 = dot(edge, edge);
  if (length2 == 0 || along < 0 || along > length2) return;
  const Vector moment = cross(edge, at);
  keep_least(least, dot(moment, moment), length2);
}

// The distance of a vertex from a face, which counts only if the foot of the perpendicular lies in the face.
void vertex_and_face(SquaredMargin& least, const Vector& p, const Vector (&face)[3]) {
  const Vector n = cross(Vector(face[1] - face[0]), Vector(face[2] - face[0]));
  if (is_zero(n)) return;
  for (int i = 0; i < 3; ++i) {
    const Vector inward = cross(n, Vector(face[(i + 1) % 3] - face[i]));
    if (dot(inward, Vector(p - face[i])) < 0) return;
  }
  const Int height = dot(n, Vector(p - face[0]));
  keep_least(least, Int(height * height), dot(n, n));
}

// The distance between two edges, which counts only if their common perpendicular meets both. w: v's start minus u's.
void edge_and_edge(SquaredMargin& least, const Vector& w, const Vector& u, const Vector& v) {
  const Vector n = cross(u, v);
  if (is_zero(n)) return;
  const Int n2 = dot(n, n), s = dot(cross(w, v), n), t = dot(cross(w, u), n);
  if (s < 0 || s > n2 || t < 0 || t > n2) return;
  const Int height = dot(n, w);
  keep_least(least, Int(height * height), n2);
}

}  // namespace

SquaredMargin exact_distance(const LargePair& pair, int exponent) {
  SquaredMargin least{0, 0, exponent};
  const auto& [a, b] = pair;
  for (int i = 0; i < 3; ++i) {
    const Vector edge_a = a[(i + 1) % 3] - a[i];
    for (int j = 0; j < 3; ++j) {
      const Vector edge_b = b[(j + 1) % 3] - b[j];
      vertex_and_vertex(least, a[i], b[j]);
      vertex_and_edge(least, b[j], a[i], edge_a);
      vertex_and_edge(least, a[i], b[j], edge_b);
      edge_and_edge(least, b[j] - a[i], edge_a, edge_b);
    }
    vertex_and_face(least, b[i], a);
    vertex_and_face(least, a[i], b);
  }
  return least;
}

SquaredMargin exact_depth(const LargePair& pair, int exponent, std::uint32_t axes) {
  SquaredMargin least{0, 0, exponent};
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    if ((axes >> axis & 1u) == 0) continue;
    const Vector n = integer_direction(pair.a, pair.b, axis);
    if (is_zero(n)) continue;
    const Int overlap = integer_overlap(pair.a, pair.b, axis, n);
    if (overlap == 0) return {0, 1, exponent};
    keep_least(least, Int(overlap * overlap), dot(n, n));
  }
  if (least.denominator == 0) least.denominator = 1;
  return least;
}

SquaredMargin exact_separation(const LargePair& pair, int exponent, int d) {
  const auto& [a, b] = pair;
  const Vector n = integer_direction(a, b, d);
  Int along_a[3], along_b[3];
  for (int i = 0; i < 3; ++i) {
    along_a[i] = dot(n, a[i]);
    along_b[i] = dot(n, b[i]);
  }
  const auto [min_a, max_a] = std::minmax_element(along_a, along_a + 3);
  const auto [min_b, max_b] = std::minmax_element(along_b, along_b + 3);
  const Int gap = std::max(Int(*min_b - *max_a), Int(*min_a - *max_b));
  if (gap <= 0) return {0, 1, exponent};
  return {gap * gap, dot(n, n), exponent};
}

int floor_log2(const SquaredMargin& margin) {
  const auto bits = [](const Int& x) { return static_cast<int>(mpz_sizeinbase(x.get_mpz_t(), 2)); };
  // 2^(log2 - 1) < numerator / denominator < 2^(log2 + 1)
  int log2 = bits(margin.numerator) - bits(margin.denominator);
  Int left = margin.numerator, right = margin.denominator;
  if (log2 > 0) right <<= static_cast<unsigned>(log2);
  if (log2 < 0) left <<= static_cast<unsigned>(-log2);
  if (left < right) --log2;
  return (log2 >> 1) + margin.exponent;  // floor(floor(x) / 2) = floor(x / 2)
}

double rounded(const SquaredMargin& margin) {
  if (margin.numerator == 0) return 0;
  // root = floor(sqrt(numerator / denominator) * 2^shift) has at least 64 bits. The root is doubled, and its lowest bit
  // is set if the root was truncated; the result rounds to 53 bits exactly like the untruncated root.
  const int shift = 64 - (floor_log2(margin) - margin.exponent);
  Int numerator = margin.numerator, denominator = margin.denominator;
  if (shift > 0) numerator <<= static_cast<unsigned>(2 * shift);
  if (shift < 0) denominator <<= static_cast<unsigned>(-2 * shift);
  const Int quotient = numerator / denominator;
  Int root = sqrt(quotient);
  const bool cut = root * root != quotient || quotient * denominator != numerator;
  root = 2 * root + (cut ? 1 : 0);
  mpfr_t value;
  mpfr_init2(value, 80);  // holds all bits of the root; mpfr_get_d below rounds only once, even to a subnormal
  mpfr_set_z_2exp(value, root.get_mpz_t(), margin.exponent - shift - 1, MPFR_RNDN);
  const double result = mpfr_get_d(value, MPFR_RNDN);
  mpfr_clear(value);
  using Limits = std::numeric_limits<double>;
  return std::clamp(result, Limits::denorm_min(), Limits::max());
}

Truth truth_of(Verdict verdict, Contact contact, const Hulls& hulls, const SquaredMargin& size, int log2_ulp) {
  const int sign = size.numerator == 0 ? 0 : verdict == Verdict::disjoint ? 1 : -1;
  SquaredMargin in_ulps = size;
  in_ulps.exponent -= log2_ulp;
  // Adding zero turns -0 into 0.
  return {{verdict, contact, sign, hulls}, sign * rounded(size) + 0.0, sign * rounded(in_ulps) + 0.0};
}

}  // namespace graze::oracle
