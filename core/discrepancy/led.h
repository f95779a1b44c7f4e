// SPDX-License-Identifier: Apache-2.0
// Runs an algorithm on certified numbers along the path of a lane's recorded run: every comparison and every choice has
// the lane's result. Each value is therefore the one that the lane would have computed without rounding, and
// carries a bound on the error that rounding can cause.
// Reference: N. J. Higham, Accuracy and Stability of Numerical Algorithms, second edition (2002), section 3.3: running
// error analysis, extended here by second-order terms, underflow and overflow.
#pragma once

#include "core/algorithms/recording.h"
#include "core/discrepancy/certified.h"

namespace graze {
inline namespace GRAZE_FP {

// Data of a whole run. If the order of some numbers is uncertain, `doubt` bounds the error of their minimum or maximum,
// and is added to the bound of every later value.
struct LedRun {
  double doubt = 0;
};

// A value without rounding, and a bound on its distance from the computed value. The bound assumes that each operation
// rounds to nearest, and holds whichever products are fused. `rounding` is infinite if the computed value may overflow
// or has no bound, or if the exact value is not known.
struct Unrounded {
  Certified exact;
  double rounding = 0;
};

// A certified number and, if the lane compared it (`was_seen`), the lane's value, which then decides comparisons.
template <class Real>
struct Led {
  Certified exact;
  mutable double rounding = 0;  // see Unrounded; comparisons may raise it
  Real lane = 0;
  bool was_seen = false;
  LedRun* run = nullptr;

  Led() = default;
  GRAZE_HD explicit Led(int constant)
      : exact(static_cast<double>(constant)), lane(static_cast<Real>(constant)), was_seen(true) {}
  GRAZE_HD Led(Real coordinate, LedRun* r) : exact(static_cast<double>(coordinate)), run(r) {}
  // `of_operands`: the result's error due to the operands' errors. `lost`: a bound on the loss by underflow.
  GRAZE_HD Led(const Certified& computed, const Led& l, const Led& r, double of_operands, double lost)
      : exact(computed), run(l.run ? l.run : r.run) {
    const double size = size_of(exact), error = certified::up(of_operands * (1 + kUnit) + kUnit * size + lost);
    rounding = size + error <= kLargest ? error : HUGE_VAL;
  }

  GRAZE_HD GRAZE_CALLED friend Led operator+(const Led& l, const Led& r) {
    return {l.exact + r.exact, l, r, l.rounding + r.rounding, 0};
  }
  GRAZE_HD GRAZE_CALLED friend Led operator-(const Led& l, const Led& r) {
    return {l.exact - r.exact, l, r, l.rounding + r.rounding, 0};
  }
  GRAZE_HD GRAZE_CALLED friend Led operator/(const Led& l, const Led& r) {
    const Certified quotient = l.exact / r.exact;
    const double least = certified::least_size(r.exact) - r.rounding;
    const double moved = least > 0 ? (l.rounding + size_of(quotient) * r.rounding) / least : HUGE_VAL;
    return {quotient, l, r, moved, l.is_zero() ? 0 : kLost};
  }
  GRAZE_HD GRAZE_CALLED friend Led sqrt(const Led& x) {
    const Certified root = sqrt(x.exact);
    const bool positive = x.exact.hi > 0 && certified::least_size(x.exact) > x.rounding;
    const double moved = x.is_zero() ? 0 : positive ? x.rounding / certified::least_size(root) : HUGE_VAL;
    return {root, x, x, moved, 0};
  }
  GRAZE_HD friend Led operator-(const Led& x) {
    Led result = x;
    result.exact = -x.exact;
    result.lane = -x.lane;
    return result;
  }
  // If the lane compared both factors, as in d0 * d1 > 0, their product is known too: contraction cannot change it.
  GRAZE_HD GRAZE_CALLED friend Led operator*(const Led& l, const Led& r) {
    const double moved = size_of(l.exact) * r.rounding + size_of(r.exact) * l.rounding + l.rounding * r.rounding;
    Led result(l.exact * r.exact, l, r, moved, l.is_zero() || r.is_zero() ? 0 : kLost);
    result.was_seen = l.was_seen && r.was_seen;
    if (result.was_seen) result.lane = l.lane * r.lane;
    return result;
  }

  GRAZE_HD friend bool operator<(const Led& l, const Led& r) {
    return compare(l, r, [](auto x, auto y) { return x < y; });
  }
  GRAZE_HD friend bool operator>(const Led& l, const Led& r) {
    return compare(l, r, [](auto x, auto y) { return x > y; });
  }
  GRAZE_HD friend bool operator<=(const Led& l, const Led& r) {
    return compare(l, r, [](auto x, auto y) { return x <= y; });
  }
  GRAZE_HD friend bool operator>=(const Led& l, const Led& r) {
    return compare(l, r, [](auto x, auto y) { return x >= y; });
  }
  GRAZE_HD friend bool operator==(const Led& l, const Led& r) {
    return compare(l, r, [](auto x, auto y) { return x == y; });
  }

 private:
  static constexpr bool kIsFloat = sizeof(Real) == sizeof(float);
  static constexpr double kUnit = kIsFloat ? 0x1p-24 : 0x1p-53,
                          kLargest = kIsFloat ? 0x1.fffffep+127 : 0x1.fffffffffffffp+1023;
  // Upper bound on the loss by underflow in a product or quotient, and in the products that compute its bound.
  static constexpr double kLost = kIsFloat ? 0x1p-147 : 0x1p-1071;

  // An upper bound on the number's magnitude.
  GRAZE_HD static double size_of(const Certified& x) { return certified::above(x) + x.bound; }
  GRAZE_HD bool is_zero() const { return exact.is_exactly_zero() && rounding == 0; }

  // Values that the lane did not record, such as the least of several distances, are compared exactly. If the order
  // of two such values is in doubt, choosing the wrong one causes an error of at most their distance. The lane may have
  // chosen the other one, so both values get the larger `rounding` of the two, which then holds for the chosen one.
  template <class Comparison>
  GRAZE_HD GRAZE_CALLED static bool compare(const Led& l, const Led& r, const Comparison& comparison) {
    if (l.was_seen && r.was_seen) return comparison(l.lane, r.lane);
    const Certified difference = l.exact - r.exact;
    const double apart = certified::above(difference);
    l.rounding = r.rounding = l.rounding < r.rounding ? r.rounding : l.rounding;
    LedRun* run = l.run ? l.run : r.run;
    if (!(apart > difference.bound) && !difference.is_exactly_zero()) run->doubt += apart + difference.bound;
    return comparison(difference.hi, 0.0);
  }
};

// The policy of a run on Led numbers. For each question of the algorithm it calls found->one(question, site, value) or
// found->two(question, site, left, right, at_most), with values as Unrounded. `site` is kSiteCount if the algorithm
// compares without an epsilon.
template <class Real, class Found>
struct LedPolicy {
  Recorded<const Real> lane;
  RecordedPath path;
  LedRun* run;
  Found* found;

  using Number = Led<Real>;

  GRAZE_HD Real value(int question, int which) const {
    return lane.values[(2 * static_cast<unsigned>(question) + static_cast<unsigned>(which)) * lane.stride];
  }
  GRAZE_HD Unrounded certain(const Number& x) const {
    Unrounded result{x.exact, x.rounding};
    if (run->doubt != 0) {
      result.exact.bound = certified::up(result.exact.bound + run->doubt);
      result.rounding = certified::up(result.rounding + run->doubt);
    }
    return result;
  }
  GRAZE_HD Number replaced(const Number& x, int question) const {
    Number result = x;
    result.lane = value(question, 0);
    result.was_seen = true;
    return result;
  }
  GRAZE_HD Number seen(int question, const Number& x) const {
    found->one(question, kSiteCount, certain(x));
    return replaced(x, question);
  }
  GRAZE_HD Number snap(const At& at, const Number& x) const {
    found->one(at.question, static_cast<int>(at.site), certain(x));
    return replaced(x, at.question);
  }
  GRAZE_HD bool less(const At& at, const Number& l, const Number& r) const {
    found->two(at.question, static_cast<int>(at.site), certain(l), certain(r), false);
    return value(at.question, 0) < value(at.question, 1);
  }
  GRAZE_HD bool at_most(const At& at, const Number& l, const Number& r) const {
    found->two(at.question, static_cast<int>(at.site), certain(l), certain(r), true);
    return value(at.question, 0) <= value(at.question, 1);
  }
  GRAZE_HD int chosen(int which, int) const { return static_cast<int>(path.path >> 4 * which & 15) - 1; }
};

template <class Algorithm, class Real, class Found>
GRAZE_HD void run_led(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Recorded<const Real>& lane,
                      const RecordedPath& path, Found& found) {
  LedRun run;
  Vec3<Led<Real>> p[3], q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = {Led<Real>(a[i].x, &run), Led<Real>(a[i].y, &run), Led<Real>(a[i].z, &run)};
    q[i] = {Led<Real>(b[i].x, &run), Led<Real>(b[i].y, &run), Led<Real>(b[i].z, &run)};
  }
  Algorithm::decide(p, q, LedPolicy<Real, Found>{lane, path, &run, &found});
}

}  // namespace GRAZE_FP
}  // namespace graze
