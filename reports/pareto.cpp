// SPDX-License-Identifier: Apache-2.0
#include "reports/pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/counts_json.h"
#include "reports/findings.h"
#include "reports/svg.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using analysis::Cost;
using analysis::Extreme;
using analysis::ExtremeCurve;
using analysis::Offer;
using analysis::Pareto;
using analysis::PolicyErrors;
using Json = nlohmann::ordered_json;

constexpr double kLeft = 76, kRight = 880, kTop = 52, kBottom = 350, kLeast = -7, kLegend = 240;
double y_of(double rate) {
  return kBottom + (kTop - kBottom) * (std::log10(std::max(rate, std::pow(10.0, kLeast))) - kLeast) / -kLeast;
}

std::string begin(const std::string& title, double right = kRight) {
  std::string svg = svg_begin(title);
  for (int power = -7; power <= 0; ++power) {
    const double y = y_of(std::pow(10.0, power));
    svg += svg_level(kLeft, right, y);
    svg += svg_text(kLeft - 8, y + 4, "end",
                    power == -7  ? "none seen"
                    : power == 0 ? "all"
                                 : fmt::format("1e{}", power));
  }
  return svg + svg_text(kLeft, 18, "start", title);
}

// The pair as input of `graze check`.
std::string numbers(const Pair& pair) {
  std::string text;
  for (int c = 0; c < kCoordinates; ++c) text += (c > 0 ? " " : "") + corpus::hex_float(coordinates(pair)[c]);
  return text;
}

Json cost_json(const Cost& cost) {
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4; };
  return {{"low", rounded(cost.low)}, {"middle", rounded(cost.middle)}, {"high", rounded(cost.high)}};
}

Json errors_json(const PolicyErrors& e) {
  Json row = {{"pairs", e.pairs}};
  row.update(fuzz::counts_json(e));
  return row;
}

std::string nanoseconds(double ns) { return fmt::format("{:.{}f}", ns, ns < 1 ? 4 : 1); }

std::vector<Offer> cheapest_first(std::vector<Offer> offers, Cost Offer::*by = &Offer::near) {
  std::stable_sort(offers.begin(), offers.end(),
                   [by](const Offer& l, const Offer& r) { return (l.*by).middle < (r.*by).middle; });
  return offers;
}

}  // namespace

std::string pareto_table(const Pareto& pareto, const Screen& screen) {
  std::vector<Column> columns = {{"lane", Align::left},
                                 {"ns a pair", Align::point},
                                 {pareto.on_device ? "with copies" : "from memory", Align::point},
                                 {"false negatives"},
                                 {"false positives"},
                                 {"declined"},
                                 {"", Align::left}};
  const std::vector<Column> more = pareto.on_device ? std::vector<Column>{{"registers"}, {"local bytes"}, {"threads"}}
                                                    : std::vector<Column>{{"one a call", Align::point}};
  columns.insert(columns.begin() + 3, more.begin(), more.end());
  TextTable table(columns);
  for (const Offer& offer : cheapest_first(pareto.offers)) {
    const PolicyErrors& e = offer.errors;
    const std::string words = offer.dominated ? "dominated"
                              : e.share_not_right() == 0
                                  ? "none: under " + rounded_up(analysis::upper_bound(0, e.pairs), 1)
                                  : "front";
    std::vector<Cell> cells = {{offer.lane},
                               {nanoseconds(offer.near.middle)},
                               {nanoseconds(offer.far.middle)},
                               {grouped(e.false_negative), e.false_negative > 0},
                               {grouped(e.false_positive), e.false_positive > 0},
                               {grouped(e.declined)},
                               {words}};
    if (!pareto.on_device) cells.insert(cells.begin() + 3, {nanoseconds(offer.alone.middle)});
    if (offer.needs) {
      const auto cell = [](int n) { return Cell{std::to_string(n)}; };
      cells.insert(cells.begin() + 3,
                   {cell(offer.needs->registers), cell(offer.needs->local_bytes), cell(offer.needs->active_threads)});
    }
    table.add(std::move(cells));
  }
  return table.text(screen);
}

std::vector<std::string> pareto_sentences(const Pareto& pareto) {
  std::vector<std::string> result, front;
  for (const Offer& offer : cheapest_first(pareto.offers, &Offer::alone)) {
    if (!analysis::is_dominated(offer, pareto.offers, &Offer::alone))
      front.push_back(fmt::format("{} ({} ns)", offer.lane, nanoseconds(offer.alone.middle)));
  }
  if (!pareto.on_device) {
    result.push_back(
        fmt::format("One pair a call, as most programs call such a test, the front is {}. A call of many pairs is "
                    "cheaper for exact lanes, which decide several at a time.",
                    fmt::join(front, ", ")));
  }
  for (const Extreme extreme : analysis::kExtremes) {
    std::vector<std::string> lanes;
    for (const ExtremeCurve& curve : pareto.curves) {
      if (curve.extreme != extreme) continue;
      const auto up = curve.right_to(1), down = extreme == Extreme::scale ? curve.right_to(-1) : std::nullopt;
      if (!up && !down) continue;
      lanes.push_back(fmt::format("{} {}{}{}", curve.lane, down ? fmt::format("down to 2^{}", *down) : "",
                                  up && down ? " and " : "", up ? fmt::format("up to 2^{}", *up) : ""));
    }
    const std::string_view what = extreme == Extreme::scale      ? "Scaled by 2^k"
                                  : extreme == Extreme::offset   ? "Offset by 2^k sizes"
                                  : extreme == Extreme::flatness ? "Flattened by 2^k"
                                                                 : "Made needles by 2^k";
    result.push_back(
        lanes.empty()
            ? fmt::format(
                  "{}: in the measured range, no lane's share of errors exceeds both 0.1 % and twice that at 2^0.",
                  what)
            : fmt::format(
                  "{}, before the share of errors exceeds both 0.1 % and twice that at 2^0: {}; the others over the "
                  "whole measured range.",
                  what, fmt::join(lanes, "; ")));
  }
  return result;
}

Json pareto_json(const Pareto& pareto) {
  Json rows = Json::array(), extremes = Json::array();
  for (const Offer& offer : cheapest_first(pareto.offers)) {
    rows.push_back({{"lane", offer.lane},
                    {"errors", errors_json(offer.errors)},
                    {"bound", analysis::upper_bound(offer.errors.not_right(), offer.errors.pairs)},
                    {pareto.on_device ? "resident" : "in_cache", cost_json(offer.near)},
                    {pareto.on_device ? "with_copies" : "from_memory", cost_json(offer.far)},
                    {"dominated", offer.dominated},
                    {"failure", offer.failure ? Json(numbers(*offer.failure)) : Json()}});
    if (!pareto.on_device) rows.back()["one_a_call"] = cost_json(offer.alone);
    if (offer.needs) {
      rows.back()["registers"] = offer.needs->registers;
      rows.back()["local_bytes"] = offer.needs->local_bytes;
      rows.back()["active_threads"] = offer.needs->active_threads;
    }
  }
  for (const ExtremeCurve& curve : pareto.curves) {
    Json points = Json::array();
    for (const auto& [k, e] : curve.points) {
      Json point = {{"log2", k}};
      point.update(errors_json(e));
      points.push_back(std::move(point));
    }
    extremes.push_back({{"lane", curve.lane}, {"extreme", name(curve.extreme)}, {"points", std::move(points)}});
  }
  return {{"machine", pareto.machine},
          {"lanes", std::move(rows)},
          {"extremes", std::move(extremes)},
          {"sentences", pareto_sentences(pareto)}};
}

std::string pareto_figure(const Pareto& pareto) {
  std::string svg = begin("Share of pairs without a right verdict, against nanoseconds a pair on " +
                          (pareto.on_device ? pareto.machine : "one core"));
  double low = 1e300, high = 0;
  for (const Offer& offer : pareto.offers) {
    low = std::min(low, offer.near.middle);
    high = std::max(high, offer.near.middle);
  }
  low = std::log10(low) - 0.1;
  high = std::max(std::log10(high) + 0.35, low + 0.5);
  const auto x_of = [&](double ns) { return kLeft + (kRight - kLeft) * (std::log10(ns) - low) / (high - low); };
  for (double decade = std::floor(low); decade <= high; ++decade) {
    for (const int step : {1, 2, 5}) {
      const double ns = step * std::pow(10.0, decade);
      if (std::log10(ns) >= low && std::log10(ns) <= high)
        svg += svg_text(x_of(ns), 370, "middle", fmt::format("{:g}", ns));
    }
  }
  svg += svg_text((kLeft + kRight) / 2, 396, "middle",
                  fmt::format("nanoseconds a pair, pairs {}", pareto.on_device ? "on the device" : "in cache"));
  std::string front;
  for (const Offer& offer : cheapest_first(pareto.offers)) {
    const double x = x_of(offer.near.middle), y = y_of(offer.errors.share_not_right());
    const char* colour = offer.dominated ? "#999" : "#d55e00";
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"><title>{}: {} ns, {} of {} "
        "pairs</title></circle>\n",
        x, y, offer.dominated ? 3 : 5, colour, offer.lane, nanoseconds(offer.near.middle),
        grouped(offer.errors.not_right()), grouped(offer.errors.pairs));
    if (offer.dominated) continue;
    front += fmt::format("{:.1f},{:.1f} ", x, y);
    svg += svg_text(x + 8, y - 6, "start", offer.lane, " fill=\"#d55e00\"");
  }
  svg += fmt::format("<polyline fill=\"none\" stroke=\"#d55e00\" stroke-opacity=\"0.5\" points=\"{}\"/>\n", front);
  return svg + "</svg>\n";
}

std::string extreme_figure(const std::vector<ExtremeCurve>& curves, Extreme extreme) {
  std::string svg =
      begin(fmt::format("Share of pairs without a right verdict, against {}: 2^k", name(extreme)), kRight - kLegend);
  const std::vector<int> at = analysis::exponents(extreme);
  const auto x_of = [&](int k) {
    return kLeft + (kRight - kLeft - kLegend) * (k - at.front()) / std::max(1, at.back() - at.front());
  };
  for (std::size_t i = 0; i < at.size(); i += std::max<std::size_t>(1, at.size() / 8))
    svg += svg_text(x_of(at[i]), 370, "middle", std::to_string(at[i]));
  std::size_t row = 0;
  for (const ExtremeCurve& curve : curves) {
    if (curve.extreme != extreme) continue;
    std::string points;
    for (const auto& [k, errors] : curve.points)
      points += fmt::format("{:.1f},{:.1f} ", x_of(k), y_of(errors.share_not_right()));
    const char* colour = kSvgColours[row % kSvgColours.size()];
    const char* dashes = row < kSvgColours.size()       ? ""
                         : row < 2 * kSvgColours.size() ? " stroke-dasharray=\"6 3\""
                                                        : " stroke-dasharray=\"2 2\"";
    svg += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{} points=\"{}\"/>\n", colour, dashes,
                       points);
    const double y = kTop + 6 + 15.0 * static_cast<double>(row);
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" stroke-width=\"3\"{4}/>\n",
        kRight - kLegend + 14, kRight - kLegend + 34, y, colour, dashes);
    svg += svg_text(kRight - kLegend + 40, y + 4, "start", curve.lane, " font-size=\"10\"");
    ++row;
  }
  return svg + "</svg>\n";
}

}  // namespace graze::reports
