// SPDX-License-Identifier: Apache-2.0
// Computes the verdict, contact and margin of one pair. The two decisions check each other.
#include "oracle/truth.h"

#include <cstdio>
#include <limits>
#include <string>

#include "oracle/exact_margin.h"
#include "oracle/integer_pair.h"

namespace graze::oracle {
namespace {

template <class Real>
Truth truth_of_pair(const BasicPair<Real>& pair) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (!is_finite(pair)) return {{Verdict::declined, Contact::unknown, 0, {}}, kNaN, kNaN};
  const Verdict verdict = cgal_verdict(pair);
  const Contact contact = gmp_contact(pair);
  if ((verdict == Verdict::disjoint) != (contact == Contact::none)) {
    throw OracleMismatch("oracle: CGAL says " + std::string(name(verdict)) + ", GMP finds contact " +
                         std::string(name(contact)) + " of" + hex(pair));
  }
  const Grid grid = grid_of(pair);
  const LargePair large = large_integers(pair, grid);
  const SquaredMargin squared =
      verdict == Verdict::disjoint ? exact_distance(large, grid.exponent) : exact_depth(large, grid.exponent, kAllAxes);
  return truth_of(verdict, contact, hulls(pair), squared, log2_ulp(pair));
}

}  // namespace

std::string hex(const DoublePair& pair) {
  std::string text;
  char number[32];
  for (int i = 0; i < kCoordinates; ++i) {
    std::snprintf(number, sizeof number, " %a", coordinates(pair)[i]);
    text += number;
  }
  return text;
}

std::string margin_words(double size) {
  using Limits = std::numeric_limits<double>;
  if (size <= Limits::denorm_min()) return "less than 1e-323";
  if (size >= Limits::max()) return "at least 1.79e308";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", size);
  return text;
}

Truth truth(const Pair& pair) { return truth_of_pair(pair); }
Truth truth(const DoublePair& pair) { return truth_of_pair(pair); }

}  // namespace graze::oracle
