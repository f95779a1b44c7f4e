// SPDX-License-Identifier: Apache-2.0
// Reads numbers as GMP rationals and multiplies all 18 by their common denominator. The oracle decides the resulting
// integers as usual. The margin is divided by the denominator at the end.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/text.h"
#include "oracle/exact_margin.h"
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

constexpr long kMostExponent = 99999;

mpz_class power(unsigned long base, unsigned long exponent) {
  mpz_class result;
  mpz_ui_pow_ui(result.get_mpz_t(), base, exponent);
  return result;
}

// Requires: text is a finite number that parse_float32 accepts.
mpq_class rational(const std::string& text) {
  std::string_view rest = text;
  const bool negative = rest.starts_with('-');
  if (negative || rest.starts_with('+')) rest.remove_prefix(1);
  const bool hex = rest.starts_with("0x") || rest.starts_with("0X");
  if (hex) rest.remove_prefix(2);
  const std::size_t exponent_at = std::min(rest.find_first_of(hex ? "pP" : "eE"), rest.size());
  long exponent = 0;
  if (exponent_at < rest.size()) {
    const std::string word(rest.substr(exponent_at + 1));
    if (word.size() > 6 || std::abs(exponent = std::stol(word)) > kMostExponent)
      throw std::runtime_error("expected an exponent of at most " + std::to_string(kMostExponent) + ", found " +
                               shown(text));
  }
  std::string digits;
  for (const char c : rest.substr(0, exponent_at)) {
    if (c != '.') digits += c;
  }
  const std::size_t point = std::min(rest.find('.'), exponent_at);
  const long places = point < exponent_at ? static_cast<long>(exponent_at - point) - 1 : 0;
  exponent -= places * (hex ? 4 : 1);
  mpq_class value(mpz_class(digits, hex ? 16 : 10));
  const mpz_class scale = power(hex ? 2 : 10, static_cast<unsigned long>(std::abs(exponent)));
  if (exponent > 0) value *= scale;
  if (exponent < 0) value /= scale;
  return negative ? mpq_class(-value) : value;
}

bool is_stored(const std::string& text, float stored) {
  return rational(text) == mpq_class(static_cast<double>(stored));
}

}  // namespace

std::vector<std::size_t> rounded(std::span<const std::string> numbers, const Pair& stored) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const float x = coordinates(stored)[i];
    if (std::isfinite(x) && !is_stored(numbers[i], x)) found.push_back(i);
  }
  return found;
}

std::optional<Truth> truth_as_written(std::span<const std::string> numbers, const Pair& stored) {
  if (!is_finite(stored) || rounded(numbers, stored).empty()) return std::nullopt;
  mpq_class values[kCoordinates];
  mpz_class denominator = 1;
  for (std::size_t i = 0; i < kCoordinates; ++i) {
    values[i] = rational(numbers[i]);
    denominator = lcm(denominator, values[i].get_den());
  }
  LargePair large;
  for (int i = 0; i < kCoordinates; ++i) {
    Vec3<mpz_class>& point = i < 9 ? large.a[i / 3] : large.b[(i - 9) / 3];
    component(point, i % 3) = mpq_class(values[i] * denominator).get_num();
  }
  const Verdict verdict = cgal_verdict(large);
  const Contact contact = gmp_contact(large);
  if ((verdict == Verdict::disjoint) != (contact == Contact::none))
    throw OracleMismatch("oracle: CGAL says " + std::string(name(verdict)) + ", GMP finds contact " +
                         std::string(name(contact)) + " for a pair as written");
  SquaredMargin squared = verdict == Verdict::disjoint ? exact_distance(large, 0) : exact_depth(large, 0, kAllAxes);
  squared.denominator *= denominator * denominator;
  return truth_of(verdict, contact, hulls(large), squared, log2_ulp(stored));
}

}  // namespace graze::oracle
