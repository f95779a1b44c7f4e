// SPDX-License-Identifier: Apache-2.0
// MPFR numbers for the algorithms: with a mantissa of any size, with or without a format's exponent limits, and with an
// error bound. Boost's wrapper is not used, because it has only decimal precisions.
#pragma once

#include <mpfr.h>

#include <algorithm>
#include <climits>
#include <compare>
#include <utility>

namespace graze::oracle {

// A number with `precision` mantissa bits, rounded to nearest even after each operation. mpfr_set_emin and
// mpfr_set_emax limit its exponent. If `subnormals` is set, underflow is gradual.
class Multi {
 public:
  static inline thread_local mpfr_prec_t precision = 53;
  static inline thread_local bool subnormals = false;
  static inline thread_local int first_event = 0;  // in a limited run: 1 overflow, -1 underflow, 0 neither so far

  Multi() : Multi(0.0) {}
  explicit Multi(int x) : Multi(double{static_cast<double>(x)}) {}
  explicit Multi(float x) : Multi(static_cast<double>(x)) {}
  explicit Multi(double x) {
    mpfr_init2(m_, precision);
    mpfr_set_d(m_, x, MPFR_RNDN);
  }
  Multi(const Multi& other) : exact_(other.exact_) {
    mpfr_init2(m_, mpfr_get_prec(other.m_));
    mpfr_set(m_, other.m_, MPFR_RNDN);
  }
  Multi(Multi&& other) noexcept : exact_(other.exact_) {
    mpfr_init2(m_, MPFR_PREC_MIN);
    mpfr_swap(m_, other.m_);
  }
  Multi& operator=(Multi other) noexcept {
    mpfr_swap(m_, other.m_);
    std::swap(exact_, other.exact_);
    return *this;
  }
  ~Multi() { mpfr_clear(m_); }

  mpfr_srcptr get() const { return m_; }
  mpfr_ptr get() { return m_; }
  bool exact() const { return exact_; }  // whether the operation that computed it was exact

  friend Multi operator+(const Multi& l, const Multi& r) { return made(mpfr_add, l, r); }
  friend Multi operator-(const Multi& l, const Multi& r) { return made(mpfr_sub, l, r); }
  friend Multi operator*(const Multi& l, const Multi& r) { return made(mpfr_mul, l, r); }
  friend Multi operator/(const Multi& l, const Multi& r) { return made(mpfr_div, l, r); }
  friend Multi operator-(const Multi& n) {
    Multi result(n);
    mpfr_neg(result.m_, n.m_, MPFR_RNDN);
    return result;
  }
  friend Multi sqrt(const Multi& n) {
    Multi result;
    result.settle(mpfr_sqrt(result.m_, n.m_, MPFR_RNDN));
    return result;
  }
  // l * m + r, rounded once.
  friend Multi fma(const Multi& l, const Multi& m, const Multi& r) {
    Multi result;
    const bool finite = mpfr_number_p(l.m_) && mpfr_number_p(m.m_) && mpfr_number_p(r.m_);
    result.settle(mpfr_fma(result.m_, l.m_, m.m_, r.m_, MPFR_RNDN));
    if (finite && mpfr_inf_p(result.m_) && first_event == 0) first_event = 1;
    return result;
  }
  friend std::partial_ordering compare_numbers(const Multi& l, const Multi& r) {
    if (mpfr_nan_p(l.m_) || mpfr_nan_p(r.m_)) return std::partial_ordering::unordered;
    return mpfr_cmp(l.m_, r.m_) <=> 0;
  }
  friend bool operator<(const Multi& l, const Multi& r) { return mpfr_less_p(l.m_, r.m_); }
  friend bool operator>(const Multi& l, const Multi& r) { return mpfr_greater_p(l.m_, r.m_); }
  friend bool operator<=(const Multi& l, const Multi& r) { return mpfr_lessequal_p(l.m_, r.m_); }
  friend bool operator>=(const Multi& l, const Multi& r) { return mpfr_greaterequal_p(l.m_, r.m_); }
  friend bool operator==(const Multi& l, const Multi& r) { return mpfr_equal_p(l.m_, r.m_); }

 private:
  using Operation = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

  static Multi made(Operation operation, const Multi& l, const Multi& r) {
    Multi result;
    const bool finite = mpfr_number_p(l.m_) && mpfr_number_p(r.m_);
    result.settle(operation(result.m_, l.m_, r.m_, MPFR_RNDN));
    if (finite && mpfr_inf_p(result.m_) && !result.exact_ && first_event == 0) first_event = 1;
    return result;
  }
  void settle(int ternary) {
    const bool tiny = subnormals && mpfr_number_p(m_) && ternary_is_tiny(ternary);
    if (subnormals) ternary = mpfr_subnormalize(m_, ternary, MPFR_RNDN);
    exact_ = ternary == 0;
    if (tiny && !exact_ && first_event == 0) first_event = -1;
  }
  // Whether the result is below the least normal number: a zero counts as below only if rounding made it zero.
  bool ternary_is_tiny(int ternary) const {
    return mpfr_zero_p(m_) ? ternary != 0 : mpfr_get_exp(m_) < mpfr_get_emin() + mpfr_get_prec(m_) - 1;
  }

  mpfr_t m_;
  bool exact_ = true;
};

// A number within 2^radius of `mid`, or `mid` itself for kExact. Numbers that the radii cannot separate count as equal.
struct Ball {
  static constexpr long kExact = LONG_MIN / 4, kUnknown = LONG_MAX / 4;
  static inline thread_local long untold = 0;  // comparisons that treated two numbers as equal without proof

  Multi mid;
  long radius = kExact;

  Ball() = default;
  template <class Number>
  explicit Ball(Number x) : mid(x) {}
  Ball(Multi m, long r) : mid(std::move(m)), radius(r) {}

  // 2^(exponent - 1) <= |mid| < 2^exponent. For zero and for numbers that are not finite, returns kExact.
  static long exponent(const Multi& m) { return mpfr_regular_p(m.get()) ? mpfr_get_exp(m.get()) : kExact; }
  // An upper bound on log2(2^r + 2^s).
  static long either(long r, long s) {
    return r == kExact ? s : s == kExact ? r : std::min(std::max(r, s) + 1, kUnknown);
  }
  static long scaled(long r, long by) {
    return r == kExact || by == kExact ? kExact : r >= kUnknown ? kUnknown : r + by;
  }
  // Adds mid's rounding error to the radius. With exponent limits, zero and infinity are regular results of the limited
  // arithmetic, so they count as exact.
  static Ball rounded(Multi mid, long radius) {
    const bool no_rounding = mid.exact() || !mpfr_regular_p(mid.get());
    const long rounding = no_rounding ? kExact : exponent(mid) - static_cast<long>(mpfr_get_prec(mid.get()));
    return {std::move(mid), either(radius, rounding)};
  }

  friend Ball operator+(const Ball& l, const Ball& r) { return rounded(l.mid + r.mid, either(l.radius, r.radius)); }
  friend Ball operator-(const Ball& l, const Ball& r) { return rounded(l.mid - r.mid, either(l.radius, r.radius)); }
  friend Ball operator-(const Ball& n) { return {-n.mid, n.radius}; }
  friend Ball operator*(const Ball& l, const Ball& r) {
    const long cross = either(scaled(l.radius, exponent(r.mid)), scaled(r.radius, exponent(l.mid)));
    return rounded(l.mid * r.mid, either(cross, scaled(l.radius, r.radius)));
  }
  // |l/r - L/R| <= (|l| 2^rr + |r| 2^rl) / (|r| (|r| - 2^rr)), and |r| - 2^rr >= |r| / 2 if r is known precisely
  // enough.
  friend Ball operator/(const Ball& l, const Ball& r) {
    const long e = exponent(r.mid);
    if (l.radius == kExact && r.radius == kExact) return rounded(l.mid / r.mid, kExact);
    if (e == kExact || r.radius > e - 3) return {l.mid / r.mid, kUnknown};
    const long from_r = scaled(scaled(r.radius, exponent(l.mid)), 3 - 2 * e), from_l = scaled(l.radius, 3 - e);
    return rounded(l.mid / r.mid, either(from_r, from_l));
  }
  // |sqrt(n) - sqrt(N)| <= |n - N| / sqrt(n)
  friend Ball sqrt(const Ball& n) {
    const long e = exponent(n.mid);
    if (n.radius == kExact) return rounded(sqrt(n.mid), kExact);
    if (e == kExact || n.radius >= e - 1) return {Multi(0), n.radius >= kUnknown ? kUnknown : n.radius / 2 + 2};
    return rounded(sqrt(n.mid), n.radius - (e - 1) / 2 + 1);
  }

  // Whether the number may be zero.
  bool can_be_zero() const { return mpfr_zero_p(mid.get()) || (radius != kExact && radius >= exponent(mid) - 1); }

  friend std::partial_ordering compare_numbers(const Ball& l, const Ball& r) {
    if (mpfr_nan_p(l.mid.get()) || mpfr_nan_p(r.mid.get())) return std::partial_ordering::unordered;
    const int sign = mpfr_cmp(l.mid.get(), r.mid.get());
    const long radius = either(l.radius, r.radius);
    const bool finite = !mpfr_inf_p(l.mid.get()) && !mpfr_inf_p(r.mid.get());
    if (radius != kExact && (finite || radius >= kUnknown)) {
      if (Ball(l.mid - r.mid, radius).can_be_zero()) {
        ++untold;
        return std::partial_ordering::equivalent;
      }
    }
    return sign < 0   ? std::partial_ordering::less
           : sign > 0 ? std::partial_ordering::greater
                      : std::partial_ordering::equivalent;
  }
};

}  // namespace graze::oracle
