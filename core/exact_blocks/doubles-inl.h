// SPDX-License-Identifier: Apache-2.0
// More code for decide.cpp, included after vectors-inl.h: numbers for pairs on large grids, and the coordinates of
// double pairs.

// Unevaluated sums of two doubles (Dekker 1971). Differences of doubles are exact. With u = 2^-53, a product of two
// such numbers has a relative error of at most 5 u^2, and a sum or difference is off by at most 3 u^2 times the
// summands' magnitudes (Joldes, Muller and Popescu 2017). A determinant is therefore off by at most (2 * 5 + 3 * 3) u^2
// plus terms of u^3, in all less than 32 u^2, times its products' magnitudes. `hi` has the number's sign and a relative
// error of at most u; the bound is doubled for `hi`. With floats nothing underflows; with doubles, the loss is within
// kDeterminantUnderflow (core/exact/error_bound.h).   Requires: fused multiply-adds, no contraction by the compiler.
struct DoubleDouble {
  static constexpr double kError = 6 * 64 * 0x1p-106;
  V hi, lo;
  static HWY_INLINE DoubleDouble difference(V l, V r) {
    const V sum = hn::Sub(l, r), part = hn::Sub(sum, l);
    return {sum, hn::Sub(hn::Sub(l, hn::Sub(sum, part)), hn::Add(r, part))};
  }
  HWY_INLINE V sign() const { return hi; }
  friend HWY_INLINE DoubleDouble operator*(const DoubleDouble& l, const DoubleDouble& r) {
    const V product = hn::Mul(l.hi, r.hi), lost = hn::MulSub(l.hi, r.hi, product);
    return quick_sum(product, hn::Add(lost, hn::MulAdd(l.hi, r.lo, hn::Mul(l.lo, r.hi))));
  }
  friend HWY_INLINE DoubleDouble operator+(const DoubleDouble& l, const DoubleDouble& r) {
    const DoubleDouble high = difference(l.hi, hn::Neg(r.hi)), low = difference(l.lo, hn::Neg(r.lo));
    const DoubleDouble sum = quick_sum(high.hi, hn::Add(high.lo, low.hi));
    return quick_sum(sum.hi, hn::Add(sum.lo, low.lo));
  }
  // Computes p q - r s.
  static HWY_INLINE DoubleDouble minor_of(const DoubleDouble& p, const DoubleDouble& q, const DoubleDouble& r,
                                          const DoubleDouble& s) {
    return p * q + DoubleDouble{hn::Neg(r.hi), hn::Neg(r.lo)} * s;
  }
  static HWY_INLINE DoubleDouble dot(const Three<DoubleDouble>& u, const Three<DoubleDouble>& v) {
    return u.x * v.x + u.y * v.y + u.z * v.z;
  }

 private:
  // Requires: |x| >= |y|, or x is zero.
  static HWY_INLINE DoubleDouble quick_sum(V x, V y) {
    const V sum = hn::Add(x, y);
    return {sum, hn::Sub(y, hn::Sub(sum, x))};
  }
};

template <>
struct CoordinatesOf<double> {
  static constexpr Tag tag{};
  V x[kNumbers];

  HWY_INLINE explicit CoordinatesOf(const double* const (&pairs)[kAtOnce]) {
    for (std::size_t c = 0; c < 16; c += 4) columns(pairs, c, x[c], x[c + 1], x[c + 2], x[c + 3]);
    V again, too;
    columns(pairs, 14, again, too, x[16], x[17]);
  }

 private:
  using FourTag = hn::FixedTag<double, 4>;
  using Four = hn::Vec<FourTag>;

  static HWY_INLINE void columns(const double* const (&pairs)[kAtOnce], std::size_t c, V& c0, V& c1, V& c2, V& c3) {
#if HWY_MAX_BYTES >= 64
    Four low[4], high[4];
    of_four(pairs, c, low);
    of_four(pairs + 4, c, high);
    c0 = hn::Combine(d, high[0], low[0]);
    c1 = hn::Combine(d, high[1], low[1]);
    c2 = hn::Combine(d, high[2], low[2]);
    c3 = hn::Combine(d, high[3], low[3]);
#else
    Four columns[4];
    of_four(pairs, c, columns);
    c0 = columns[0];
    c1 = columns[1];
    c2 = columns[2];
    c3 = columns[3];
#endif
  }

  // Loads four coordinates of each of four pairs, starting at coordinate c.
  static HWY_INLINE void of_four(const double* const* pairs, std::size_t c, Four (&columns)[4]) {
    constexpr FourTag four;
    const Four r0 = hn::LoadU(four, pairs[0] + c), r1 = hn::LoadU(four, pairs[1] + c),
               r2 = hn::LoadU(four, pairs[2] + c), r3 = hn::LoadU(four, pairs[3] + c);
    const Four even_01 = hn::InterleaveLower(four, r0, r1), even_23 = hn::InterleaveLower(four, r2, r3);
    const Four odd_01 = hn::InterleaveUpper(four, r0, r1), odd_23 = hn::InterleaveUpper(four, r2, r3);
    columns[0] = hn::ConcatLowerLower(four, even_23, even_01);
    columns[1] = hn::ConcatLowerLower(four, odd_23, odd_01);
    columns[2] = hn::ConcatUpperUpper(four, even_23, even_01);
    columns[3] = hn::ConcatUpperUpper(four, odd_23, odd_01);
  }
};
