// SPDX-License-Identifier: Apache-2.0
// The curves of `graze tune`: errors as a tolerance varies over its range, at all sites or at one site.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "analysis/sweep.h"

namespace graze::analysis {

// The range of tolerances, as powers of two. Absolute tolerances are in units of the cube of a typical length.
inline constexpr double kLeastTolerance = -60, kMostTolerance = 20;

// The number in a tolerance's name, such as "rel:24" or "separation=abs:1e-6".
double tolerance_of(const std::string& policy);

// The name of a tolerance: "separation=abs:1e-06"; without a site, "abs:1e-06".
std::string tolerance(const std::string& site, bool relative, double value);

// log2 of the cube of the pairs' typical size. A pair's size is its largest difference of coordinates; the typical size
// is the median.
int log2_cube(Sources sources);

// The numbers low, low + step, …, high.
std::vector<double> steps(double low, double high, double step);

// A tolerance swept over its range. Point: PolicyErrors or Agreement.
template <class Point>
struct CurveOf {
  std::string site;  // empty: all sites
  bool relative = false;
  std::vector<Point> points;  // ordered by tolerance
};

// Adds a point to each curve for each exponent of two in steps_of(curve). One sweep computes all points.
// cube: log2 of the unit of absolute tolerances.
template <class Point, class SweepPolicies, class StepsOf>
void add_points(std::vector<CurveOf<Point>>& curves, int cube, const SweepPolicies& sweep, const StepsOf& steps_of) {
  std::vector<std::string> policies;
  std::vector<std::size_t> ends;
  for (const CurveOf<Point>& curve : curves) {
    for (const double at : steps_of(curve))
      policies.push_back(tolerance(curve.site, curve.relative, std::exp2(at + (curve.relative ? 0 : cube))));
    ends.push_back(policies.size());
  }
  const std::vector<Point> found = sweep(policies);
  std::size_t begin = 0;
  for (std::size_t c = 0; c < ends.size(); begin = ends[c++]) {
    std::vector<Point>& points = curves[c].points;
    for (std::size_t p = begin; p < ends[c]; ++p) {
      const bool known = std::any_of(points.begin(), points.end(),
                                     [&](const Point& point) { return point.policy == found[p].policy; });
      if (!known) points.push_back(found[p]);
    }
    std::stable_sort(points.begin(), points.end(),
                     [](const Point& l, const Point& r) { return tolerance_of(l.policy) < tolerance_of(r.policy); });
  }
}

// Sweeps whole powers of two, then quarters of an octave around the best point of each curve. best: the index of a
// curve's best point.
template <class Point, class SweepPolicies, class Best>
void sweep_curves(std::vector<CurveOf<Point>>& curves, int cube, const SweepPolicies& sweep, const Best& best) {
  add_points(curves, cube, sweep, [](const auto&) { return steps(kLeastTolerance, kMostTolerance, 1); });
  add_points(curves, cube, sweep, [&](const CurveOf<Point>& curve) {
    const double at = kLeastTolerance + static_cast<double>(best(curve));
    return steps(at - 1, at + 1, 0.25);
  });
}

// Like sweep_curves, but for absolute curves in which each point needs a build. So a curve has fewer points: 0, every
// fourth power of two, and smaller steps around the best point. The range is wide, because the epsilon may bound a
// length, an area or a volume.
template <class Point, class SweepPolicies, class Best>
void sweep_values(std::vector<CurveOf<Point>>& curves, int cube, const SweepPolicies& sweep, const Best& best) {
  const int size = cube / 3;  // log2 of a typical length
  const double least = std::min(size, cube) - 48, most = std::max(size, cube) + 4;
  add_points(curves, 0, sweep, [&](const auto&) {
    std::vector<double> powers = steps(least, most, 4);
    powers.insert(powers.begin(), -std::numeric_limits<double>::infinity());  // the value 0
    return powers;
  });
  for (const double step : {1.0, 0.25}) {
    add_points(curves, 0, sweep, [&](const CurveOf<Point>& curve) {
      const double value = tolerance_of(curve.points[static_cast<std::size_t>(best(curve))].policy);
      const double at = std::round(4 * std::log2(value)) / 4;  // the name holds a rounded value
      return std::isfinite(at) ? steps(at - 3 * step, at + 3 * step, step) : std::vector<double>();
    });
  }
}

}  // namespace graze::analysis
