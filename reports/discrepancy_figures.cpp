// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "reports/discrepancy.h"
#include "reports/discrepancy_reading.h"
#include "reports/plain_figures.h"
#include "reports/svg.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kFewBars = 6;  // this many bars or fewer have room for their counts

// A bar chart of counts on a logarithmic scale: one series upwards and, if given, another downwards.
std::string mirrored_bars(const std::string& title, const std::vector<std::string>& labels,
                          const std::vector<std::uint64_t>& up_counts, const std::vector<std::uint64_t>& down_counts,
                          const std::string& up_name, const std::string& down_name) {
  constexpr double kLeft = 60, kRight = 880, kMiddle = 220, kHeight = 145;
  std::uint64_t most = 1;
  for (const auto* counts : {&up_counts, &down_counts}) {
    for (const std::uint64_t count : *counts) most = std::max(most, count);
  }
  const double logs = std::log10(static_cast<double>(most)) + 0.3;
  const auto height = [&](std::uint64_t count) {
    return count == 0 ? 0 : kHeight * (std::log10(static_cast<double>(count)) + 0.3) / logs;
  };
  std::string svg = svg_begin(html(title)) + svg_text(kLeft, 24, "start", html(title), " font-size=\"15\"") +
                    svg_text(kLeft, 44, "start", "up: " + html(up_name), fmt::format(" fill=\"{}\"", kSvgColours[1])) +
                    (down_counts.empty() ? ""
                                         : svg_text(kLeft + 380, 44, "start", "down: " + html(down_name),
                                                    fmt::format(" fill=\"{}\"", kSvgColours[0])));
  const double base = down_counts.empty() ? kMiddle + kHeight : kMiddle;
  const double step = (kRight - kLeft) / static_cast<double>(std::max<std::size_t>(labels.size(), 1));
  svg += svg_level(kLeft, kRight, base);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double x = kLeft + step * static_cast<double>(i);
    const auto bar = [&](std::uint64_t count, bool down) {
      if (count == 0) return std::string();
      const double high = height(count) * (down_counts.empty() ? 2 : 1);
      return fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"><title>{}: "
          "{}</title></rect>\n",
          x + 1, down ? base : base - high, std::max(step - 2, 1.0), high, kSvgColours[down ? 0 : 1], html(labels[i]),
          grouped(count));
    };
    svg += bar(up_counts[i], false);
    if (!down_counts.empty()) svg += bar(down_counts[i], true);
    if (labels.size() <= kFewBars)
      svg += svg_text(x + step / 2, base - 2 * height(up_counts[i]) - 6, "middle", grouped(up_counts[i]));
    const std::size_t every = (labels.size() + 15) / 16;
    if (i % every == 0) svg += svg_text(x + step / 2, 392, "middle", html(labels[i]));
  }
  return svg + svg_text(kRight, 412, "end", "bars: logarithm of the count") + "</svg>\n";
}

}  // namespace

std::string errors_figure(const Json& of) {
  auto first = sum_by_bucket(of.at("total"), "first_error"), second = sum_by_bucket(of.at("total"), "second_error");
  std::vector<std::string> labels = {"0", "1/2"};
  for (int k = 0; k < 36; ++k) labels.push_back(octave(k));
  while (labels.size() > 4 && first[labels.back()] + second[labels.back()] == 0) labels.pop_back();
  labels.insert(labels.end(), {"not finite", "unknown"});
  std::vector<std::uint64_t> ups, downs;
  for (const std::string& label : labels) ups.push_back(first[label]), downs.push_back(second[label]);
  return mirrored_bars("Error against the exact value, in ulps: at most", labels, ups, downs, text_at(of, "first"),
                       text_at(of, "second"));
}

std::string differences_figure(const Json& of) {
  auto above = sum_by_bucket(of.at("total"), "above"), below = sum_by_bucket(of.at("total"), "below");
  int most = 0;
  for (const auto* sums : {&above, &below}) {
    for (const auto& [bucket, count] : *sums) most = std::max(most, power_of(bucket));
  }
  std::vector<std::string> labels;
  std::vector<std::uint64_t> ups, downs;
  for (int k = 0; k <= most; ++k) {
    labels.push_back(octave(k));
    ups.push_back(above[labels.back()]);
    downs.push_back(below[labels.back()]);
  }
  return mirrored_bars("Difference in ulps: at least", labels, ups, downs, text_at(of, "second") + " is higher",
                       "it is lower");
}

std::string funnel_figure(const Json& of) {
  const Json& total = of.at("total");
  return mirrored_bars(
      "From differing values to differing verdicts: pairs of triangles",
      {"all", "a value differs", "a sign or choice differs", "a comparison differs", "the verdict differs"},
      {number_at(total, "pairs"), number_at(total, "differs"), number_at(total, "sign"), number_at(total, "outcome"),
       number_at(total, "verdict")},
      {}, "pairs", "");
}

std::string band_figure(const Json& of) {
  Octaves bands;
  for (const Json& question : of.at("total").at("questions")) {
    for (const auto& [bucket, count] : question.at("band").items()) {
      if (bucket != "unknown") bands[power_of(bucket)] += count.get<std::uint64_t>();
    }
  }
  if (bands.empty()) return "";
  std::vector<std::string> labels;
  std::vector<std::uint64_t> counts;
  for (int k = bands.begin()->first; k <= bands.rbegin()->first; ++k) {
    labels.push_back(octave(k));
    counts.push_back(bands[k]);
  }
  return mirrored_bars("The critical band: size of values whose sign differs, in bounds of their rounding error",
                       labels, counts, {}, "signs that differ", "");
}

namespace {

constexpr std::uint64_t kFewestPairs = 30;  // shares of fewer pairs are not drawn

// The lines in the picture of shares by scale or offset: the name of the count, and the label.
constexpr std::pair<const char*, const char*> kShareLines[] = {
    {"differs", "a value differs"}, {"sign", "a sign"}, {"outcome", "a comparison"}, {"verdict", "the verdict"}};

// Draws shares of pairs by their position on an axis, on a logarithmic scale. places: the counts, by log2 of the lower
// end of each interval of the axis.
std::string extremes_figure(const std::string& title, const std::string& unit,
                            const std::map<int, const Json*>& places) {
  constexpr double kLeft = 64, kRight = 880;
  constexpr RateAxis kShares{70, 350, -6};
  const int low = places.begin()->first, high = places.rbegin()->first;
  const auto x_of = [&](int power) { return kLeft + (kRight - kLeft) * (power - low) / std::max(high - low, 1); };
  std::string svg = svg_begin(html(title)) + svg_text(kLeft, 24, "start", html(title), " font-size=\"15\"") +
                    kShares.levels(kLeft, kRight, "none");
  double x = kLeft;
  for (std::size_t l = 0; l < std::size(kShareLines); ++l) {
    const auto& [count, label] = kShareLines[l];
    std::string points, marks;
    for (const auto& [power, counts] : places) {
      const std::uint64_t pairs = number_at(*counts, "pairs"), part = number_at(*counts, count);
      const double y = kShares.y(part_of(part, pairs));
      points += fmt::format("{:.1f},{:.1f} ", x_of(power), y);
      marks += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"><title>2^{}: {} of {}</title></circle>\n",
          x_of(power), y, kSvgColours[l], power, grouped(part), grouped(pairs));
    }
    svg += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n", kSvgColours[l],
                       points) +
           marks + svg_text(x, 46, "start", label, fmt::format(" fill=\"{}\"", kSvgColours[l]));
    x += 140;
  }
  const std::size_t every = (places.size() + 11) / 12;
  std::size_t place = 0;
  for (const auto& [power, counts] : places) {
    if (place++ % every == 0) svg += svg_text(x_of(power), 374, "middle", octave(power));
  }
  return svg + svg_text(kRight, 404, "end", unit) + "</svg>\n";
}

}  // namespace

std::string extremes_figures(const Json& of) {
  std::string figures;
  for (const auto& [stratum, counts] : of.at("strata").items()) {
    for (const auto& [axis, rows] : counts.at("extremes").items()) {
      std::map<int, const Json*> places;
      for (const auto& [power, row] : rows.items()) {
        if (number_at(row, "pairs") >= kFewestPairs) places[std::stoi(power)] = &row;
      }
      if (places.empty()) continue;
      const bool scale = axis == "scale";
      figures += extremes_figure(
          fmt::format("Shares of the pairs of {} that differ, by {}", stratum,
                      scale ? "scale" : "distance from the origin"),
          scale ? "largest coordinate: at least" : "largest coordinate / size of the pair: at least", places);
    }
  }
  return figures;
}

}  // namespace graze::reports
