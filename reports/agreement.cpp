// SPDX-License-Identifier: Apache-2.0
#include "reports/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "fuzz/counts_json.h"
#include "reports/findings.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "reports/tolerance_figure.h"
#include "reports/tuning.h"

namespace graze::reports {
namespace {

using analysis::Agreed;
using analysis::Agreement;
using analysis::TuneResult;
using Json = nlohmann::ordered_json;

std::string under(const std::string& policy) { return policy.empty() ? "without a policy" : "under " + policy; }

// "302 of {} (1.51 %)"
std::string differing(const Agreement& a, const std::string& pairs) {
  return fmt::format("{} of {}{}", grouped(a.differing), pairs,
                     a.differing == 0 ? "" : fmt::format(" ({})", rate_words(a.differing, a.pairs)));
}

const std::string kSamePairs = "the same pairs";

// Whether the chosen tolerance is the sweep's smallest, which does not cover ordinary rounding errors.
bool is_smallest(const Agreed& a) {
  return std::any_of(a.curves.begin(), a.curves.end(),
                     [&](const auto& curve) { return curve.points.front().policy == a.chosen; });
}

std::string answer(const AgreeQuestion& q, const Agreed& a) {
  const std::string both = q.lanes[0] + " and " + q.lanes[1];
  const std::string high = fmt::format("at 95 % confidence the rate is under {}", rounded_up(a.high, 2)),
                    low = fmt::format("at 95 % confidence the rate is over {}", rounded_down(a.low, 2));
  const std::string found =
      fmt::format("{} the verdicts of {} differ on {}", under(a.chosen), both,
                  differing(a.confirmed, fmt::format("{} fresh pairs", grouped(a.confirmed.pairs))));
  switch (a.result) {
    case TuneResult::satisfied:
      return a.chosen.empty() ? fmt::format("No policy is needed: {}; {}.", found, high)
                              : fmt::format("Use {} in both: {}; {}.", a.chosen, found, high);
    case TuneResult::too_few_pairs:
      return fmt::format(
          "Not settled: {}; {}, and {} was asked for. {}", found, high, q.max_rate,
          a.confirmed.differing > 0
              ? "More pairs (--pairs) may settle it."
              : fmt::format(
                    "To show such a rate, use at least {} pairs (--pairs), on all of which the lanes must agree.",
                    grouped(static_cast<std::uint64_t>(std::ceil(std::log(0.05) / std::log1p(-q.max_rate))))));
    case TuneResult::not_confirmed:
      return fmt::format(
          "Not settled: {}; {}. The rate was at most {} on the pairs that the tolerance was chosen on, but not on "
          "these. More pairs (--pairs) or a stricter --max-rate may find a tolerance that keeps the rate.",
          found, low, q.max_rate);
    case TuneResult::not_satisfiable:
    case TuneResult::not_useful:  // never happens: differing verdicts are of one kind
      break;
  }
  return fmt::format("No tolerance that was tried keeps the rate of differing verdicts at or under {}. {}: {}; {}.",
                     q.max_rate, a.chosen.empty() ? "None improves on having no policy" : a.chosen + " comes nearest",
                     found, low);
}

std::string errors(const Counts& counts) {
  return fmt::format("{} false negatives and {} false positives", grouped(counts.false_negative),
                     grouped(counts.false_positive));
}

Json agreement_row(const Agreement& a) {
  Json errors = Json::array();
  for (const Counts& counts : a.of) errors.push_back(fuzz::counts_json(counts));
  return {{"policy", a.policy}, {"pairs", a.pairs}, {"intersecting", a.intersecting}, {"differing", a.differing},
          {"mended", a.mended}, {"added", a.added}, {"errors", std::move(errors)}};
}

Json rows(const std::vector<Agreement>& agreements) {
  Json result = Json::array();
  for (const Agreement& agreement : agreements) result.push_back(agreement_row(agreement));
  return result;
}

}  // namespace

std::vector<std::string> agreement_sentences(const AgreeQuestion& q, const Agreed& a) {
  std::vector<std::string> result = {answer(q, a)};
  if (!a.chosen.empty()) {
    if (is_smallest(a))
      result.push_back(fmt::format(
          "{} is the smallest tolerance of the sweep and covers no ordinary rounding error. It helps only by side "
          "effects: with tolerances in the code the compiler may fuse other products, and the size of a quotient is "
          "enormous where cancellation leaves a tiny divisor. {} is the clearer remedy.",
          a.chosen, q.flag.empty() ? "Exact arithmetic" : q.flag));
    const Agreement& now = a.confirmed;
    result.push_back(
        fmt::format("Without a policy the verdicts differ on {}.", differing(a.zero_confirmed, kSamePairs)));
    result.push_back(fmt::format(
        "{}: under {} the lanes now agree on {} of these pairs, still differ on {}, and newly differ on {} others.",
        2 * now.added > now.mended ? "The tolerance mostly moves the differences" : "Effect of the tolerance", a.chosen,
        grouped(now.mended), grouped(now.differing - now.added), grouped(now.added)));
  }
  for (std::size_t l = 0; l < 2; ++l) {
    const Counts &before = a.zero_confirmed.of[l], &now = a.confirmed.of[l];
    result.push_back(
        a.chosen.empty()
            ? fmt::format("Compared with the exact truth, {} has {} on these pairs.", q.lanes[l], errors(before))
            : fmt::format("Price for {}: {}; without a policy {}.", q.lanes[l], errors(now), errors(before)));
  }
  if (a.blunt)
    result.push_back(fmt::format(
        "Blunt: under {} the lanes agree on the {} pairs that it was chosen on, but are wrong on {} and {} of these "
        "pairs. Giving all pairs the same answer would be as good.",
        a.blunt->policy, grouped(a.blunt->pairs), grouped(a.blunt->of[0].wrong()), grouped(a.blunt->of[1].wrong())));
  if (!q.without_relative.empty())
    result.push_back(fmt::format("Relative tolerances are left out: {} has no twin under them.", q.without_relative));
  if (a.rounded && q.rounded[0] == q.rounded[1])
    result.push_back(fmt::format("Without a tolerance: built with {}, both lanes are {}.", q.flag, q.rounded[0]));
  else if (a.rounded)
    result.push_back(fmt::format(
        "Without a tolerance: built with {}, {} and {} differ on {}; at 95 % confidence the rate is under {}.", q.flag,
        q.rounded[0], q.rounded[1], differing(*a.rounded, kSamePairs),
        rounded_up(analysis::upper_bound(a.rounded->differing, a.rounded->pairs), 2)));
  result.push_back(fmt::format("The exact lanes (exact/{0}/cpu and exact/{0}/cuda) never differ and are never wrong.",
                               q.exact_scalar));
  return result;
}

std::string agreement_table(const AgreeQuestion& q, const Agreed& a, const Screen& screen) {
  std::vector<Column> columns = {{"tolerance", Align::left}, {"verdicts that differ"}};
  for (const std::string& lane : q.lanes) {
    const std::string variant = lane.substr(lane.rfind('/') + 1);
    columns.push_back({variant + ": false negatives"});
    columns.push_back({variant + ": false positives"});
  }
  TextTable table(std::move(columns));
  const auto add = [&](const Agreement& row) {
    table.add({row.policy.empty() ? "none" : row.policy, grouped(row.differing), grouped(row.of[0].false_negative),
               grouped(row.of[0].false_positive), grouped(row.of[1].false_negative),
               grouped(row.of[1].false_positive)});
  };
  add(a.zero_confirmed);
  for (const Agreement& pick : a.picks) {
    if (pick.mended + pick.added > 0) add(pick);
  }
  return fmt::format("The best tolerance of each kind and site, on {} pairs:\n{}", grouped(a.zero_confirmed.pairs),
                     table.text(screen));
}

Json agreement_json(const AgreeQuestion& q, const Agreed& a) {
  Json json = {{"lanes", q.lanes},
               {"max_rate", q.max_rate},
               {"chosen", a.chosen.empty() ? "zero" : a.chosen},
               {"result", kTuneResults[static_cast<int>(a.result)]},
               {"low", a.low},
               {"high", a.high},
               {"confirmed", agreement_row(a.confirmed)},
               {"zero_confirmed", agreement_row(a.zero_confirmed)},
               {"picks", rows(a.picks)},
               {"blunt", a.blunt ? agreement_row(*a.blunt) : Json()},
               {"without_relative", q.without_relative.empty() ? Json() : Json(q.without_relative)},
               {"rounded", Json()},
               {"zero", agreement_row(a.zero)},
               {"curves", Json::array()},
               {"sentences", agreement_sentences(q, a)}};
  if (a.rounded) json["rounded"] = {{"lanes", q.rounded}, {"flag", q.flag}, {"agreement", agreement_row(*a.rounded)}};
  for (const analysis::CurveOf<Agreement>& curve : a.curves)
    json["curves"].push_back({{"site", curve.site.empty() ? "all" : curve.site},
                              {"tolerance", curve.relative ? "rel" : "abs"},
                              {"points", rows(curve.points)}});
  return json;
}

std::string agreement_figure(const AgreeQuestion& q, const Agreed& a) {
  const std::string wrong[] = {"wrong: " + q.lanes[0], "wrong: " + q.lanes[1]};
  return tolerance_figure(fmt::format("Agreement of {} and {}", q.lanes[0], q.lanes[1]),
                          "Share of differing and of wrong verdicts against the tolerance at all sites; dashed: chosen",
                          a.curves, a.chosen,
                          {{"#009e73", "differing verdicts", [](const Agreement& e) { return e.differing; }},
                           {"#0072b2", wrong[0], [](const Agreement& e) { return e.of[0].wrong(); }},
                           {"#d55e00", wrong[1], [](const Agreement& e) { return e.of[1].wrong(); }}});
}

}  // namespace graze::reports
