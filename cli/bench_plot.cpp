// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cli/bench_rows.h"
#include "reports/svg.h"

namespace graze::cli {
namespace {

using reports::svg_text;

constexpr double kWidth = 900, kHeight = 420, kLeft = 64, kRight = 300, kTop = 44, kBottom = 52;
// The decades that a logarithmic axis must span to show the given values.
struct Decades {
  int low = 99, high = -99;
  void hold(double value) {
    low = std::min(low, static_cast<int>(std::floor(std::log10(value))));
    high = std::max(high, static_cast<int>(std::ceil(std::log10(value))));
  }
  double share(double value) const { return high > low ? (std::log10(value) - low) / (high - low) : 0.5; }
};

std::string power(int exponent) { return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", exponent); }

}  // namespace

std::string bench_plot(const Bench& bench, const std::string& machine) {
  std::map<std::string, std::map<double, double>> series;
  Decades sizes, rates;
  for (const BenchRow& row : bench.rows) {
    const bool of_2012 = row.lane == "interval_overlap/f32/cpu" || row.lane == "interval_overlap/f32/cuda-fma";
    if (row.array != "thesis" || row.mode != "all" || !(row.lane == "exact" || of_2012)) continue;
    if (row.executor.ends_with("twin") || row.data == "resident, split") continue;
    const double size = static_cast<double>(row.triangles);
    series[fmt::format("{}, {}", row.lane, row.by())][size] = row.rate();
    sizes.hold(size);
    rates.hold(row.rate());
  }
  const auto x_of = [&](double size) { return kLeft + (kWidth - kLeft - kRight) * sizes.share(size); };
  const auto y_of = [&](double rate) { return kHeight - kBottom - (kHeight - kTop - kBottom) * rates.share(rate); };
  std::string svg = reports::svg_begin("Triangles per second against array size");
  svg += svg_text(kLeft, 20, "start", "Triangles per second against array size. " + machine);
  for (int k = rates.low; k <= rates.high; ++k) {
    const double y = y_of(std::pow(10.0, k));
    svg += reports::svg_level(kLeft, kWidth - kRight, y);
    svg += svg_text(kLeft - 8, y + 4, "end", power(k));
  }
  for (int k = sizes.low; k <= sizes.high; ++k)
    svg += svg_text(x_of(std::pow(10.0, k)), kHeight - kBottom + 20, "middle", power(k));
  svg += svg_text((kLeft + kWidth - kRight) / 2, kHeight - 10, "middle", "triangles in the array");
  std::size_t row = 0;
  for (const auto& [name, points] : series) {
    const char* colour = reports::kSvgColours[row % reports::kSvgColours.size()];
    std::string line, dots;
    for (const auto& [size, rate] : points) {
      line += fmt::format("{:.1f},{:.1f} ", x_of(size), y_of(rate));
      dots +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x_of(size), y_of(rate), colour);
    }
    svg +=
        fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n{}", colour, line, dots);
    const double y = kTop + 10 + 22 * static_cast<double>(row++), x = kWidth - kRight + 16;
    svg += fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"4\"/>\n", x, x + 16,
        y, y, colour);
    svg += svg_text(x + 22, y + 4, "start", name);
  }
  return svg + "</svg>\n";
}

}  // namespace graze::cli
