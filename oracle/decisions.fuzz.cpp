// SPDX-License-Identifier: Apache-2.0
// On pairs of floats or doubles with arbitrary bits, the exact decision must agree with GMP's and CGAL's decisions. The
// certified bounds must contain the exact margin, rounded once by MPFR.
#include <cmath>

#include "core/exact/exact.h"
#include "core/fuzz_pair.h"
#include "core/fuzz_target.h"
#include "core/margin/margin.h"
#include "core/relation_of.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

const RegisterFuzzTarget kExact("exact", [](std::string_view bytes) {
  const Pair pair = finite_pair_of(bytes);
  exact::Stage stage;
  const bool intersects = exact::intersects(coordinates(pair), coordinates(pair) + 9, &stage);
  const Contact contact = gmp_contact(pair);
  must_hold(intersects == (cgal_verdict(pair) == Verdict::intersects), "the exact decision and CGAL's are the same");
  must_hold(intersects == (contact != Contact::none), "the exact decision and GMP's are the same");
  reached(static_cast<std::size_t>(stage) * 8 + static_cast<std::size_t>(contact));
});

const RegisterFuzzTarget kExactDoubles("exact_doubles", [](std::string_view bytes) {
  const DoublePair pair = finite_pair_of<double>(bytes);
  exact::Stage stage;
  const bool intersects = exact::intersects(coordinates(pair), coordinates(pair) + 9, &stage);
  const Relation relation = relation_of(pair);
  must_hold(intersects == (cgal_verdict(pair) == Verdict::intersects), "the exact decision and CGAL's are the same");
  must_hold(intersects == relation.intersects(), "the exact decision and the exact relation are the same");
  must_hold(relation.contact == gmp_contact(pair), "the exact contact and GMP's are the same");
  must_hold(relation.hulls == hulls(pair), "the exact hulls and GMP's are the same");
  reached(static_cast<std::size_t>(stage) * 8 + static_cast<std::size_t>(relation.contact));
});

const RegisterFuzzTarget kMargin("margin", [](std::string_view bytes) {
  const Pair pair = finite_pair_of(bytes);
  const Truth truth = oracle::truth(pair);
  const MarginBounds bounds = margin_bounds(pair, truth.verdict);
  const double margin = std::fabs(truth.margin);
  must_hold(bounds.lo <= margin && margin <= bounds.hi, "the margin lies within the bounds");
  must_hold((truth.verdict == Verdict::disjoint) == (truth.margin > 0), "the margin's sign agrees with the verdict");
});

}  // namespace
}  // namespace graze::oracle
