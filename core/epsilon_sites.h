// SPDX-License-Identifier: Apache-2.0
// Epsilon policies: every comparison that a paper or a library guards with an epsilon goes through a policy.
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

inline namespace GRAZE_FP {

// The default policy: exact comparison. Other policies treat small values as zero; a tracing policy records.
struct ExactZero {
  // Returns x, or zero if the policy treats x as zero.
  template <class Real>
  GRAZE_HD Real snap(Site, const Real& x) const {
    return x;
  }

  // True if the policy is certain that l < r. (Not l - r < 0: a subtraction would invite contraction.)
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
