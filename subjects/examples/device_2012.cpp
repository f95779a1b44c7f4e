// SPDX-License-Identifier: Apache-2.0
// The algorithms of the 2012 thesis as subjects. DEVICE_MAD, DEVICE_FUSES and DEVICE_DIVISION select a device's
// arithmetic; see docs/results/2012.toml. Without DEVICE_MAD, the algorithms compute in float.
#include "subjects/examples/device_2012.h"

#include "core/algorithms/interval_overlap.h"
#include "core/algorithms/projected_sat.h"

namespace {

#ifdef DEVICE_MAD
#ifndef DEVICE_FUSES
#define DEVICE_FUSES left
#endif
#ifndef DEVICE_DIVISION
#define DEVICE_DIVISION reciprocal
#endif
using graze::device_2012::Mad, graze::device_2012::Fuses, graze::device_2012::Division;
using Real = graze::device_2012::Number<{Mad::DEVICE_MAD, Fuses::DEVICE_FUSES, Division::DEVICE_DIVISION}>;
#else
using Real = float;
#endif

template <class Algorithm>
bool decide(const float a[9], const float b[9]) {
  const auto corner = [](const float* p) { return graze::Vec3<Real>{Real(p[0]), Real(p[1]), Real(p[2])}; };
  const graze::Vec3<Real> p[3] = {corner(a), corner(a + 3), corner(a + 6)};
  const graze::Vec3<Real> q[3] = {corner(b), corner(b + 3), corner(b + 6)};
  return Algorithm::decide(p, q) == graze::Verdict::intersects;
}

}  // namespace

bool interval_overlap(const float a[9], const float b[9]) { return decide<graze::IntervalOverlap>(a, b); }

bool projected_sat(const float a[9], const float b[9]) { return decide<graze::ProjectedSat>(a, b); }
