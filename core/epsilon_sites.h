// SPDX-License-Identifier: Apache-2.0
// Epsilon policies. If a paper or a library guards a comparison with an epsilon, our code asks a policy instead.
#pragma once

#include <string_view>

#include "core/vec3.h"

namespace graze {

// Where an algorithm compares with an epsilon.
enum class Site {
  plane_distance,  // a vertex's (unnormalised) signed distance to the other triangle's plane
  parallel,        // a component of the cross product of the two normals
  orientation,     // an orientation determinant
  separation,      // the gap between two intervals: projections on an axis, or sections of a line
};
inline constexpr int kSiteCount = 4;

constexpr std::string_view name(Site site) {
  constexpr std::string_view kNames[] = {"plane_distance", "parallel", "orientation", "separation"};
  return kNames[static_cast<int>(site)];
}

// A question to a policy: the site, and the question's number in the algorithm. Each number stands for one source line
// and the same quantities in every run; see core/discrepancy/questions.h.
struct At {
  Site site;
  int question;
  GRAZE_HD constexpr At(Site s, int q) : site(s), question(q) {}
  GRAZE_HD constexpr operator Site() const { return site; }
};

inline namespace GRAZE_FP {

// Shows the policy a value that the algorithm compares without an epsilon. Only recording policies use this.
template <class Policy, class Real>
GRAZE_HD void see([[maybe_unused]] const Policy& policy, [[maybe_unused]] int question, [[maybe_unused]] Real& x) {
  if constexpr (requires { policy.seen(question, x); }) x = policy.seen(question, x);
}

// Tells the policy about a choice, such as an axis, that later quantities depend on. Only recording policies use this.
// Requires: 0 <= value < 15, which < 15.
template <class Policy, class Choice>
GRAZE_HD Choice chosen(const Policy& policy, int which, Choice value) {
  if constexpr (requires { policy.chosen(which, 0); }) {
    return static_cast<Choice>(policy.chosen(which, static_cast<int>(value)));
  } else {
    return value;
  }
}

// Like `chosen`, for a choice that depends only on recorded values.
template <class Policy>
GRAZE_HD void choose([[maybe_unused]] const Policy& policy, [[maybe_unused]] int which, [[maybe_unused]] int value) {
  if constexpr (requires { policy.chosen(which, 0); }) policy.chosen(which, value);
}

// The default policy: exact comparison. Other policies treat small values as zero; a tracing policy records values.
struct ExactZero {
  // Returns x, or zero if the policy treats x as zero.
  template <class Real>
  GRAZE_HD Real snap(Site, const Real& x) const {
    return x;
  }

  // True if the policy is certain that l < r. (Do not compute l - r < 0: a compiler might contract it.)
  template <class Real>
  GRAZE_HD bool less(Site, const Real& l, const Real& r) const {
    return l < r;
  }

  // True if l <= r or if they are too close to tell; false for NaN.
  template <class Real>
  GRAZE_HD bool at_most(Site, const Real& l, const Real& r) const {
    return l <= r;
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
