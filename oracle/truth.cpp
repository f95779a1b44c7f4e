// SPDX-License-Identifier: Apache-2.0
// Verdict, contact and margin of one pair, each decision confirmed by the other.
#include "oracle/truth.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "oracle/exact_margin.h"
#include "oracle/integer_pair.h"

namespace graze::oracle {
namespace {

std::string hex_coordinates(const Pair& pair) {
  std::string text;
  char number[32];
  for (int i = 0; i < kCoordinates; ++i) {
    std::snprintf(number, sizeof number, " %a", static_cast<double>(coordinates(pair)[i]));
    text += number;
  }
  return text;
}

}  // namespace

Truth truth(const Pair& pair) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (!is_finite(pair)) return {{Verdict::declined, Contact::unknown, 0, {}}, kNaN, kNaN};
  const Verdict verdict = cgal_verdict(pair);
  const Contact contact = gmp_contact(pair);
  if ((verdict == Verdict::disjoint) != (contact == Contact::none)) {
    throw OracleApart("oracle: CGAL says " + std::string(name(verdict)) + ", GMP finds contact " +
                      std::string(name(contact)) + " of" + hex_coordinates(pair));
  }
  const Grid grid = grid_of(pair);
  const LargePair large = large_integers(pair, grid);
  constexpr std::uint32_t kAllAxes = (1u << kSeparatingAxes) - 1;
  const double margin = verdict == Verdict::disjoint ? rounded(exact_distance(large, grid.exponent))
                                                     : -rounded(exact_depth(large, grid.exponent, kAllAxes));
  // Adding zero turns -0 into 0; the power of two is exact, for margins stay far from the ends of double.
  const int sign = (margin > 0) - (margin < 0);
  return {{verdict, contact, sign, hulls(pair)}, margin + 0.0, std::ldexp(margin, -log2_ulp(pair)) + 0.0};
}

}  // namespace graze::oracle
