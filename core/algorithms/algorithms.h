// SPDX-License-Identifier: Apache-2.0
// The list of algorithms. To add a subject, write one header and add one entry here. The lane table, the device lanes,
// tests, campaigns, benchmarks and `graze lanes` iterate over this list.
#pragma once

#include <tuple>

#include "core/algorithms/guigue_devillers_2003.h"
#include "core/algorithms/interval_overlap.h"
#include "core/algorithms/moller_1997.h"
#include "core/algorithms/projected_sat.h"
#include "core/algorithms/separating_axes.h"
#include "core/pair.h"

namespace graze {
inline namespace GRAZE_FP {

using Algorithms = std::tuple<ProjectedSat, IntervalOverlap, Moller1997, GuigueDevillers2003, SeparatingAxes>;
inline constexpr int kAlgorithmCount = std::tuple_size_v<Algorithms>;

// Widens the pair's coordinates to Real and returns decide(a, b).
template <class Real, class Decide>
GRAZE_HD Verdict decide_widened(const Pair& pair, const Decide& decide) {
  Vec3<Real> a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = {Real(pair.a[i].x), Real(pair.a[i].y), Real(pair.a[i].z)};
    b[i] = {Real(pair.b[i].x), Real(pair.b[i].y), Real(pair.b[i].z)};
  }
  return decide(a, b);
}

// One algorithm's decision in one scalar type.
template <class Algorithm, class Real>
GRAZE_HD Verdict decide_widened(const Pair& pair) {
  return decide_widened<Real>(pair, [](const auto& a, const auto& b) { return Algorithm::decide(a, b); });
}

}  // namespace GRAZE_FP
}  // namespace graze
