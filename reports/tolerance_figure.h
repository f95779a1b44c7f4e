// SPDX-License-Identifier: Apache-2.0
// Draws rates against the tolerance at all sites. Relative tolerances are on the left, absolute ones on the right.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/curves.h"
#include "reports/svg.h"

namespace graze::reports {

// A line of the picture, and the count that it shows.
template <class Point>
struct ToleranceLine {
  std::string_view colour, label;
  std::function<std::uint64_t(const Point&)> count;
};

template <class Point>
std::string tolerance_figure(std::string_view title, std::string_view heading,
                             const std::vector<analysis::CurveOf<Point>>& curves, const std::string& chosen,
                             const std::vector<ToleranceLine<Point>>& lines) {
  constexpr RateAxis kRates{64, 350, -7};
  std::string svg = svg_begin(title) + kRates.levels(64, 880, "none");
  const auto of_all = [&](bool relative) {
    return std::any_of(curves.begin(), curves.end(), [&](const analysis::CurveOf<Point>& curve) {
      return curve.site.empty() && curve.relative == relative && !curve.points.empty();
    });
  };
  const bool both = of_all(true) && of_all(false);
  for (analysis::CurveOf<Point> curve : curves) {
    std::erase_if(curve.points, [](const Point& p) { return analysis::tolerance_of(p.policy) == 0; });  // no logarithm
    if (!curve.site.empty() || curve.points.empty()) continue;
    const double low = std::log2(analysis::tolerance_of(curve.points.front().policy)),
                 high = std::log2(analysis::tolerance_of(curve.points.back().policy));
    const double left = both && !curve.relative ? 484 : 64, right = both && curve.relative ? 460 : 880;
    const auto x_of = [&](double tolerance) {
      return left + (right - left) * (std::log2(tolerance) - low) / (high - low);
    };
    for (const ToleranceLine<Point>& line : lines) {
      std::string points;
      for (const Point& point : curve.points)
        points += fmt::format("{:.1f},{:.1f} ", x_of(analysis::tolerance_of(point.policy)),
                              kRates.y(static_cast<double>(line.count(point)) /
                                       static_cast<double>(std::max<std::uint64_t>(point.pairs, 1))));
      svg += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n", line.colour,
                         points);
    }
    for (const Point& point : curve.points) {
      if (point.policy == chosen)
        svg += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"64\" y2=\"350\" stroke=\"#777\" stroke-dasharray=\"4 3\"/>\n",
            x_of(analysis::tolerance_of(point.policy)));
    }
    for (const double at : {low, (low + high) / 2, high})
      svg += svg_text(x_of(std::exp2(at)), 370,
                      at == low    ? "start"
                      : at == high ? "end"
                                   : "middle",
                      fmt::format("{}:{:.2g}", curve.relative ? "rel" : "abs", std::exp2(at)));
  }
  if (of_all(true))
    svg += svg_text(both ? 262 : 472, 396, "middle", "K, in machine epsilons times the quantity’s size");
  if (of_all(false)) svg += svg_text(both ? 682 : 472, 396, "middle", "E, in the quantity’s own unit");
  svg += svg_text(64, 18, "start", heading);
  double x = 64;
  for (const ToleranceLine<Point>& line : lines) {
    svg += fmt::format("<line x1=\"{0}\" x2=\"{1}\" y1=\"36\" y2=\"36\" stroke=\"{2}\" stroke-width=\"4\"/>\n", x,
                       x + 16, line.colour);
    svg += svg_text(x + 21, 40, "start", line.label);
    x += std::max(168.0, 50 + 6.5 * static_cast<double>(line.label.size()));
  }
  return svg + "</svg>\n";
}

}  // namespace graze::reports
