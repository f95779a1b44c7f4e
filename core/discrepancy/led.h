// SPDX-License-Identifier: Apache-2.0
// Runs an algorithm on certified numbers down the path that a lane's recorded run took. Its values are those that the
// lane would have without rounding, if all its comparisons and choices stayed the same.
#pragma once

#include "core/algorithms/recording.h"
#include "core/discrepancy/certified.h"

namespace graze {
inline namespace GRAZE_FP {

// Data of a whole run. If the order of some numbers is in doubt, `doubt` bounds the error of their least or greatest.
// It adds to the bound of every later value.
struct LedRun {
  double doubt = 0;
};

// A certified number. If the lane compared it (`was_seen`), it also has the lane's value, which decides comparisons.
template <class Real>
struct Led {
  Certified exact;
  Real lane = 0;
  bool was_seen = false;
  LedRun* run = nullptr;

  Led() = default;
  GRAZE_HD explicit Led(int constant)
      : exact(static_cast<double>(constant)), lane(static_cast<Real>(constant)), was_seen(true) {}
  GRAZE_HD Led(Real coordinate, LedRun* r) : exact(static_cast<double>(coordinate)), run(r) {}
  GRAZE_HD Led(const Certified& computed, const Led& l, const Led& r) : exact(computed), run(l.run ? l.run : r.run) {}

  GRAZE_HD friend Led operator+(const Led& l, const Led& r) { return {l.exact + r.exact, l, r}; }
  GRAZE_HD friend Led operator-(const Led& l, const Led& r) { return {l.exact - r.exact, l, r}; }
  GRAZE_HD friend Led operator/(const Led& l, const Led& r) { return {l.exact / r.exact, l, r}; }
  GRAZE_HD friend Led sqrt(const Led& x) { return {sqrt(x.exact), x, x}; }
  GRAZE_HD friend Led operator-(const Led& x) {
    Led result = x;
    result.exact = -x.exact;
    result.lane = -x.lane;
    return result;
  }
  // A product of values that the lane compares, like d0 * d1 > 0, is the lane's product: no contraction reaches it.
  GRAZE_HD friend Led operator*(const Led& l, const Led& r) {
    Led result(l.exact * r.exact, l, r);
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
  // Values that the lane did not record are compared exactly: the least of several distances, for example. If their
  // order is in doubt, the wrong choice is off by at most their distance.
  template <class Comparison>
  GRAZE_HD static bool compare(const Led& l, const Led& r, const Comparison& comparison) {
    if (l.was_seen && r.was_seen) return comparison(l.lane, r.lane);
    const Certified difference = l.exact - r.exact;
    const double apart = certified::above(difference);
    LedRun* run = l.run ? l.run : r.run;
    if (!(apart > difference.bound) && !difference.is_exactly_zero()) run->doubt += apart + difference.bound;
    return comparison(difference.hi, 0.0);
  }
};

// The policy of such a run. `found(question, site, left, right)` gets the certified values of each question that the
// lane was asked; `right` is null for a question about one value. site: kSiteCount for one that the source compares
// itself.
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
  GRAZE_HD Certified certain(const Number& x) const {
    Certified result = x.exact;
    if (run->doubt != 0) result.bound = certified::up(result.bound + run->doubt);
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
