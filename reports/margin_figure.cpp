// SPDX-License-Identifier: Apache-2.0
// A campaign's picture: how often each f32/cpu lane is wrong, against the size of the margin.
#include "reports/report.h"

#include <fmt/format.h>

#include <map>

#include "core/margin/bucket.h"
#include "reports/counts.h"
#include "reports/svg.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWidth = 900, kHeight = 420, kLeft = 64, kRight = 20, kTop = 64, kBottom = 66;
constexpr int kSpan = 26;                   // on each side of 0, draws buckets from 2^(-kSpan/2) to 2^kSpan ulps
constexpr std::uint64_t kFewestPairs = 30;  // shares of fewer pairs are not drawn
constexpr std::size_t kColours = 6;         // how many of kSvgColours are used

// The position of a bucket on the axis: small margins in the middle, -2^26 at the left end, +2^26 at the right end.
int place(int bucket) {
  if (bucket == 0) return 0;
  const int k = (bucket < 0 ? -bucket : bucket) + kBucketLowest - 1;
  const int from_zero = std::clamp(k, -kSpan / 2, kSpan) + kSpan / 2 + 1;
  return bucket < 0 ? -from_zero : from_zero;
}

double x_of(int p) {
  constexpr int kMost = kSpan + kSpan / 2 + 1;
  return kLeft + (kWidth - kLeft - kRight) * (p + kMost) / (2.0 * kMost);
}

double y_of(double share) { return kHeight - kBottom - (kHeight - kTop - kBottom) * share; }

std::string axes() {
  std::string svg;
  for (int percent = 0; percent <= 100; percent += 25) {
    svg += svg_level(kLeft, kWidth - kRight, y_of(percent / 100.0));
    svg += svg_text(kLeft - 8, y_of(percent / 100.0) + 4, "end", fmt::format("{} %", percent));
  }
  for (const int k : {24, 12, 0, -12}) {
    const int bucket = k - kBucketLowest + 1;
    svg += svg_text(x_of(place(bucket)), kHeight - kBottom + 18, "middle",
                    fmt::format("2<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", k));
    svg += svg_text(x_of(place(-bucket)), kHeight - kBottom + 18, "middle",
                    fmt::format("2<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", k));
  }
  svg += svg_text(x_of(0), kHeight - kBottom + 18, "middle", "0");
  svg += svg_text(x_of(-20), kHeight - 14, "middle", "intersecting, by depth in ulps");
  svg += svg_text(x_of(0), kHeight - 30, "middle", "touching");
  svg += svg_text(x_of(20), kHeight - 14, "middle", "disjoint, by distance in ulps");
  return svg;
}

}  // namespace

constexpr std::size_t kInLegendRow = 5;

std::string margin_figure(const Json& summary) {
  const CampaignCounts counts = counts_of(summary);
  std::map<int, WrongCounts> by_place;
  for (const auto& [bucket, found] : counts.total.margins) {
    WrongCounts& sum = by_place[place(bucket)];
    sum.pairs += found.pairs;
    sum.wrong.resize(counts.lanes.size());
    for (std::size_t l = 0; l < sum.wrong.size(); ++l) sum.wrong[l] += found.wrong[l];
  }

  std::string svg = svg_begin("Share of wrong verdicts against the exact margin");
  svg += axes();
  std::size_t row = 0;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const std::string& id = counts.lanes[l].id;
    if (!id.ends_with("/f32/cpu")) continue;
    const char* colour = kSvgColours[row % kColours];
    std::string points;
    for (const auto& [p, found] : by_place) {
      if (found.pairs < kFewestPairs) continue;
      points += fmt::format("{:.1f},{:.1f} ", x_of(p),
                            y_of(static_cast<double>(found.wrong[l]) / static_cast<double>(found.pairs)));
    }
    svg += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n", colour, points);
    const double x = kLeft + 168.0 * static_cast<double>(row % kInLegendRow), y = row < kInLegendRow ? 36 : 52;
    svg +=
        fmt::format("<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{3}\" y2=\"{3}\" stroke=\"{2}\" stroke-width=\"4\"/>\n",
                    x, x + 16, colour, y);
    svg += svg_text(x + 21, y + 4, "start", id.substr(0, id.find('/')));
    ++row;
  }
  svg += svg_text(kLeft, 18, "start",
                  "Share of wrong verdicts, float32 on the CPU, against the exact margin (all strata)");
  return svg + "</svg>\n";
}

}  // namespace graze::reports
