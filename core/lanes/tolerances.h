// SPDX-License-Identifier: Apache-2.0
// The policies abs, rel and paper: at each site, a number smaller than a tolerance counts as zero.
#pragma once

#include "core/epsilon_sites.h"
#include "core/lanes/with_magnitude.h"

namespace graze {

// A site's tolerance: `absolute`, in the quantity's unit, plus `relative` * machine epsilon * the quantity's size.
struct Epsilons {
  double absolute[kSiteCount] = {};
  double relative[kSiteCount] = {};

  bool operator==(const Epsilons&) const = default;
  GRAZE_HD bool any_relative() const {
    for (const double k : relative) {
      if (k != 0) return true;
    }
    return false;
  }
};

inline namespace GRAZE_FP {

// For plain numbers only the absolute tolerance counts. Tolerances of zero give the same values as ExactZero.
template <class Real>
struct Tolerances {
  Real absolute[kSiteCount];
  Real relative[kSiteCount];  // machine epsilon included

  GRAZE_HD explicit Tolerances(const Epsilons& epsilons) {
    constexpr Real epsilon = sizeof(Real) == sizeof(float) ? Real(0x1p-23) : Real(0x1p-52);
    for (int s = 0; s < kSiteCount; ++s) {
      absolute[s] = static_cast<Real>(epsilons.absolute[s]);
      relative[s] = static_cast<Real>(epsilons.relative[s]) * epsilon;
    }
  }

  // The comparison is strict, as in published code: |x| < epsilon. NaN is not near zero.
  GRAZE_HD bool near_zero(Site site, const Real& x) const { return magnitude(x) < absolute[static_cast<int>(site)]; }
  GRAZE_HD bool near_zero(Site site, const WithMagnitude<Real>& x) const {
    const int s = static_cast<int>(site);
    return magnitude(x.value) < absolute[s] + relative[s] * x.size;
  }

  template <class Number>
  GRAZE_HD Number snap(Site site, const Number& x) const {
    return near_zero(site, x) ? Number(0) : x;
  }

  template <class Number>
  GRAZE_HD bool less(Site site, const Number& l, const Number& r) const {
    return l < r && !near_zero(site, r - l);
  }

  template <class Number>
  GRAZE_HD bool at_most(Site site, const Number& l, const Number& r) const {
    return l <= r || near_zero(site, l - r);
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
