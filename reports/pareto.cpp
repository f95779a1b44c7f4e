// SPDX-License-Identifier: Apache-2.0
#include "reports/pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/text.h"
#include "fuzz/counts_json.h"
#include "fuzz/minimise/kinds.h"
#include "reports/cost_words.h"
#include "reports/extremes.h"
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

constexpr double kLeft = 76, kRight = 880, kLegend = 240;
constexpr RateAxis kRates{52, 350, -7};

std::string begin(const std::string& title, double right = kRight) {
  return svg_begin(title) + kRates.levels(kLeft, right, "none seen") + svg_text(kLeft, 18, "start", title);
}

Json cost_json(const Cost& cost) {
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4; };
  return {{"low", rounded(cost.low)}, {"middle", rounded(cost.middle)}, {"high", rounded(cost.high)}};
}

Json errors_json(const PolicyErrors& e) {
  Json row = {{"pairs", e.pairs}};
  row.update(fuzz::counts_json(e, e.any_foreign()));
  return row;
}

const char* changed_words(Extreme extreme) {
  switch (extreme) {
    case Extreme::scale:
      return "Scaled by 2^k";
    case Extreme::offset:
      return "Moved by 2^k sizes";
    case Extreme::flatness:
      return "Flattened by 2^k";
    case Extreme::aspect:
      break;
  }
  return "Narrowed by 2^k";
}

std::string nanoseconds(double ns) { return fmt::format("{:.{}f}", ns, ns < 1 ? 4 : 1); }
std::string nanoseconds(const std::optional<Cost>& cost) { return cost ? nanoseconds(cost->middle) : "-"; }

// Sorts offers by a cost. Offers without this cost come last.
std::vector<Offer> cheapest_first(std::vector<Offer> offers, std::optional<Cost> Offer::*by = &Offer::near) {
  const auto cost = [by](const Offer& offer) { return (offer.*by) ? (offer.*by)->middle : HUGE_VAL; };
  std::stable_sort(offers.begin(), offers.end(), [&](const Offer& l, const Offer& r) { return cost(l) < cost(r); });
  return offers;
}

std::vector<Offer> timed(std::vector<Offer> offers) {
  std::erase_if(offers, [](const Offer& offer) { return !offer.near; });
  return offers;
}

// "12 false negatives, 0 false positives, 3 crashed, timed out or unstable on 100 pairs"
std::string errors_in_words(const PolicyErrors& e) {
  std::string words =
      fmt::format("{} false negatives, {} false positives", grouped(e.false_negative), grouped(e.false_positive));
  if (e.failed() > 0) words += fmt::format(", {} crashed, timed out or unstable", grouped(e.failed()));
  if (e.declined > 0) words += fmt::format(", {} declined", grouped(e.declined));
  if (e.by_convention > 0) words += fmt::format(", {} allowed by its convention", grouped(e.by_convention));
  return words + fmt::format(" on {} pairs", grouped(e.pairs));
}

Json offer_json(const Offer& offer) {
  return {{"lane", offer.lane},
          {"errors", errors_json(offer.errors)},
          {"bound", analysis::upper_bound(offer.errors.not_true(), offer.errors.pairs)},
          {"failure", offer.failure ? Json(fuzz::pair_text(*offer.failure)) : Json()}};
}

// Explains the cost columns.
std::string costs_of_table(const Pareto& pareto) {
  const char* const columns =
      pareto.on_device ? "`ns a pair` for pairs already on the device, `with copies` for pairs in pinned memory"
                       : "`ns a pair` for calls of 4,096 pairs in its cache, `from memory` for calls of 2^19 pairs, "
                         "`one a call` for calls of one pair";
  return fmt::format(
      "Costs are times per pair on {}{}: {}. They are medians of passes over the pairs of this run; pareto.json has "
      "their quartiles.",
      pareto.on_device ? "" : "one core of ", pareto.machine, columns);
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
  const auto any = [&](auto count) {
    return std::any_of(pareto.offers.begin(), pareto.offers.end(),
                       [&](const Offer& offer) { return std::invoke(count, offer.errors) > 0; });
  };
  const bool any_failed = any(&Counts::failed);
  const bool any_by_convention = any(&Counts::by_convention);
  const std::vector<Column> more = pareto.on_device ? std::vector<Column>{{"registers"}, {"local bytes"}, {"threads"}}
                                                    : std::vector<Column>{{"one a call", Align::point}};
  columns.insert(columns.begin() + 3, more.begin(), more.end());
  if (any_failed) columns.insert(columns.end() - 2, {"crashed, timed out or unstable"});
  if (any_by_convention) columns.insert(columns.end() - 1, {"allowed by its convention"});
  TextTable table(columns);
  for (const Offer& offer : cheapest_first(pareto.offers)) {
    const PolicyErrors& e = offer.errors;
    const std::string words = !offer.near       ? "not timed"
                              : offer.dominated ? "dominated"
                              : e.share_not_true() == 0
                                  ? "none: under " + rounded_up(analysis::upper_bound(0, e.pairs), 1)
                                  : "front";
    std::vector<Cell> cells = {{offer.lane},
                               {nanoseconds(offer.near)},
                               {nanoseconds(offer.far)},
                               {grouped(e.false_negative), e.false_negative > 0},
                               {grouped(e.false_positive), e.false_positive > 0},
                               {grouped(e.declined)},
                               {words}};
    if (!pareto.on_device) cells.insert(cells.begin() + 3, {nanoseconds(offer.alone)});
    if (any_failed) cells.insert(cells.end() - 2, {grouped(e.failed()), e.failed() > 0});
    if (any_by_convention) cells.insert(cells.end() - 1, {grouped(e.by_convention)});
    if (pareto.on_device) {
      using Needs = cuda::KernelNeeds;
      const auto cell = [&](int Needs::*need) {
        return Cell{offer.needs ? std::to_string((*offer.needs).*need) : "-"};
      };
      cells.insert(cells.begin() + 3,
                   {cell(&Needs::registers), cell(&Needs::local_bytes), cell(&Needs::active_threads)});
    }
    table.add(std::move(cells));
  }
  return table.text(screen);
}

std::vector<std::string> pareto_sentences(const Pareto& pareto) {
  std::vector<std::string> result, front;
  for (const Offer& offer : cheapest_first(pareto.offers, &Offer::alone)) {
    if (offer.alone && !analysis::is_dominated(offer, pareto.offers, &Offer::alone))
      front.push_back(fmt::format("{} {}", offer.lane, cost_words(*offer.alone)));
  }
  if (!pareto.on_device && !front.empty()) {
    result.push_back(
        fmt::format("With one pair per call, as most programs call such a test, the front is {}. Calls of many pairs "
                    "are cheaper per pair for exact lanes, which decide several pairs at a time.",
                    fmt::join(front, ", ")));
  }
  result.push_back(costs_of_table(pareto));
  std::vector<std::string> names;
  std::vector<analysis::Cost> near;
  for (const Offer& offer : timed(pareto.offers)) {
    names.push_back(offer.lane);
    near.push_back(*offer.near);
  }
  if (const std::string noisy = noisy_sentence(names, near); !noisy.empty()) result.push_back(noisy);
  for (const Offer& offer : pareto.offers) {
    if (!offer.near)
      result.push_back(fmt::format("{}: {}. Not timed, because {}.", offer.lane, errors_in_words(offer.errors),
                                   offer.why_not_timed));
  }
  return result;
}

std::string extremes_text(const Pareto& pareto, const Screen& screen) {
  const bool any_not_counted = std::any_of(pareto.curves.begin(), pareto.curves.end(), [](const ExtremeCurve& curve) {
    return std::any_of(curve.points.begin(), curve.points.end(),
                       [](const auto& point) { return point.second.not_true() > point.second.wrong(); });
  });
  std::string text = wrapped(
      std::string(kAsRightMeans) + (any_not_counted ? " Here a verdict that is declined, or that a convention allows, "
                                                      "counts as an error."
                                                    : ""),
      screen.columns);
  for (const Offer& offer : pareto.offers) {
    text += offer.lane + '\n';
    for (const ExtremeCurve& curve : pareto.curves) {
      if (curve.lane != offer.lane) continue;
      text += wrapped(fmt::format("{}: {}.", changed_words(curve.extreme), right_words(curve.errors(), 0)),
                      screen.columns, 2, 4);
    }
  }
  return text;
}

Json pareto_json(const Pareto& pareto) {
  Json rows = Json::array(), not_timed = Json::array(), extremes = Json::array();
  for (const Offer& offer : cheapest_first(pareto.offers)) {
    Json row = offer_json(offer);
    if (!offer.near) {
      row["why"] = offer.why_not_timed;
      not_timed.push_back(std::move(row));
      continue;
    }
    row[pareto.on_device ? "resident" : "in_cache"] = cost_json(*offer.near);
    row[pareto.on_device ? "with_copies" : "from_memory"] = cost_json(*offer.far);
    if (offer.alone) row["one_a_call"] = cost_json(*offer.alone);
    row["dominated"] = offer.dominated;
    if (offer.needs) {
      row["registers"] = offer.needs->registers;
      row["local_bytes"] = offer.needs->local_bytes;
      row["active_threads"] = offer.needs->active_threads;
    }
    rows.push_back(std::move(row));
  }
  for (const ExtremeCurve& curve : pareto.curves) {
    Json points = Json::array();
    for (const auto& [k, e] : curve.points) {
      Json point = {{"log2", k}};
      point.update(errors_json(e));
      points.push_back(std::move(point));
    }
    extremes.push_back({{"lane", curve.lane},
                        {"extreme", name(curve.extreme)},
                        {"says", right_words(curve.errors(), 0)},
                        {"points", std::move(points)}});
  }
  Json json = {{"machine", pareto.machine}, {"lanes", std::move(rows)}};
  if (!not_timed.empty()) json["not_timed"] = std::move(not_timed);
  json["extremes"] = std::move(extremes);
  json["sentences"] = pareto_sentences(pareto);
  return json;
}

std::string pareto_figure(const Pareto& pareto) {
  std::string svg = begin("Share of pairs without a correct verdict, against nanoseconds a pair on " +
                          (pareto.on_device ? pareto.machine : "one core"));
  double low = 1e300, high = 0;
  for (const Offer& offer : timed(pareto.offers)) {
    low = std::min(low, offer.near->middle);
    high = std::max(high, offer.near->middle);
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
  for (const Offer& offer : cheapest_first(timed(pareto.offers))) {
    const double x = x_of(offer.near->middle), y = kRates.y(offer.errors.share_not_true());
    const char* colour = offer.dominated ? "#999" : "#d55e00";
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"><title>{}: {} ns, {} of {} "
        "pairs</title></circle>\n",
        x, y, offer.dominated ? 3 : 5, colour, offer.lane, nanoseconds(offer.near), grouped(offer.errors.not_true()),
        grouped(offer.errors.pairs));
    if (offer.dominated) continue;
    front += fmt::format("{:.1f},{:.1f} ", x, y);
    svg += svg_text(x + 8, y - 6, "start", offer.lane, " fill=\"#d55e00\"");
  }
  svg += fmt::format("<polyline fill=\"none\" stroke=\"#d55e00\" stroke-opacity=\"0.5\" points=\"{}\"/>\n", front);
  return svg + "</svg>\n";
}

std::string extreme_figure(const std::vector<ExtremeCurve>& curves, Extreme extreme) {
  std::string svg =
      begin(fmt::format("Share of pairs without a correct verdict, against {}: 2^k", name(extreme)), kRight - kLegend);
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
      points += fmt::format("{:.1f},{:.1f} ", x_of(k), kRates.y(errors.share_not_true()));
    const char* colour = kSvgColours[row % kSvgColours.size()];
    const char* dashes = row < kSvgColours.size()       ? ""
                         : row < 2 * kSvgColours.size() ? " stroke-dasharray=\"6 3\""
                                                        : " stroke-dasharray=\"2 2\"";
    svg += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{} points=\"{}\"/>\n", colour, dashes,
                       points);
    const double y = kRates.top + 6 + 15.0 * static_cast<double>(row);
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" stroke-width=\"3\"{4}/>\n",
        kRight - kLegend + 14, kRight - kLegend + 34, y, colour, dashes);
    svg += svg_text(kRight - kLegend + 40, y + 4, "start", curve.lane, " font-size=\"10\"");
    ++row;
  }
  return svg + "</svg>\n";
}

}  // namespace graze::reports
