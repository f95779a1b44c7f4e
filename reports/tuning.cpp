// SPDX-License-Identifier: Apache-2.0
#include "reports/tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/text.h"
#include "fuzz/counts_json.h"
#include "reports/findings.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "reports/tolerance_figure.h"

namespace graze::reports {
namespace {

using analysis::Forbid;
using analysis::PolicyErrors;
using analysis::Tuned;
using analysis::TuneResult;
using Json = nlohmann::ordered_json;

std::string_view words(Forbid forbid) {
  return forbid == Forbid::false_negative   ? "false negatives"
         : forbid == Forbid::false_positive ? "false positives"
                                            : "wrong verdicts";
}

std::string_view other_words(Forbid forbid) {
  return words(forbid == Forbid::false_negative ? Forbid::false_positive : Forbid::false_negative);
}

// "rel:24"; for a user's epsilon "kEps = 3.05e-05f" or, if it has no name, "3.05e-05f for 1e-6f".
std::string policy_words(const TuneQuestion& q, const std::string& policy) {
  if (!q.source) return policy.empty() ? "no policy" : policy;
  const subjects::Epsilon& e = q.source->epsilon;
  const bool named = e.name != e.written;
  const std::string name = printable(e.name), written = printable(e.written);
  if (policy.empty()) return named ? fmt::format("{} as it is, {}", name, written) : written + " as it is";
  const std::string value = subjects::written_value(e, analysis::tolerance_of(policy));
  return named ? fmt::format("{} = {}", name, value) : fmt::format("{} for {}", value, written);
}

// "kEps = 3.05e-05f at mine.cpp:9 (now 1e-6f)"
std::string choice_words(const TuneQuestion& q, const std::string& policy) {
  const std::string words = policy_words(q, policy);
  if (!q.source) return words;
  const subjects::Epsilon& e = q.source->epsilon;
  return fmt::format("{} at {}{}", words, subjects::places_in_words(q.source->file, e),
                     policy.empty() || e.name == e.written ? "" : fmt::format(" (now {})", printable(e.written)));
}

// The word for the tuned quantity, as in "No tolerance that was tried is good enough here".
std::string_view setting(const TuneQuestion& q) { return q.source ? "value" : "tolerance"; }

// "12 false negatives (0.012 %) and 0 false positives of 100,000 pairs"
std::string errors(const PolicyErrors& e) {
  const auto part = [&](std::uint64_t count, std::string_view what) {
    return fmt::format("{} {}{}", grouped(count), what,
                       count == 0 ? "" : fmt::format(" ({})", rate_words(count, e.pairs)));
  };
  const std::string failed = e.failed() == 0 ? "" : ", " + part(e.failed(), "crashed, timed out or unstable");
  const auto beside = [](std::uint64_t count, const char* what) {
    return count == 0 ? "" : fmt::format(", and {} {}", grouped(count), what);
  };
  return fmt::format("{}{} and {} of {} pairs{}{}", part(e.false_negative, "false negatives"), failed,
                     part(e.false_positive, "false positives"), grouped(e.pairs), beside(e.declined, "declined"),
                     beside(e.by_convention, "allowed by its convention"));
}

// Names the errors that double from one scale to another: all errors, or only the forbidden kind.
std::string_view doubled_words(const TuneQuestion& q, const PolicyErrors& here, const PolicyErrors& there) {
  return analysis::doubles(here.wrong(), there.wrong(), here.pairs) ? "errors" : words(q.forbid);
}

// Describes how many pairs would show that the rate is under the limit, if further pairs had errors at the same rate.
std::string pairs_to_show(const TuneQuestion& q, const Tuned& t) {
  const std::uint64_t errors = analysis::forbidden(t.confirmed, q.forbid), pairs = t.confirmed.pairs;
  if (errors == 0)
    return fmt::format("To show such a rate, use at least {} pairs (--pairs), none with an error.",
                       grouped(static_cast<std::uint64_t>(std::ceil(std::log(0.05) / std::log1p(-q.max_rate)))));
  for (std::uint64_t times = 2; times <= 1024; times *= 2) {
    if (analysis::upper_bound(times * errors, times * pairs) <= q.max_rate)
      return fmt::format("{} pairs (--pairs) with errors at this rate would suffice.", grouped(times * pairs));
  }
  return "The rate is too near the limit, or above it, so more pairs would not help.";
}

std::string answer(const TuneQuestion& q, const Tuned& t) {
  const std::string on = "on pairs that were not used to choose it, " + errors(t.confirmed),
                    of = choice_words(q, t.chosen) + ": " + on;
  std::string trust = fmt::format("at 95 % confidence {} are under {}", words(q.forbid), rounded_up(t.bound, 2));
  if (q.forbid != Forbid::any)
    trust += fmt::format(", {} under {}", other_words(q.forbid), rounded_up(t.other_bound, 2));
  switch (t.result) {
    case TuneResult::satisfied:
      if (!t.chosen.empty() && t.zero_confirmed.wrong() <= t.confirmed.wrong() &&
          analysis::forbidden(t.zero_confirmed, q.forbid) <= analysis::forbidden(t.confirmed, q.forbid))
        return fmt::format("Leave it as it is, since {} is no better: {}; {}.", policy_words(q, t.chosen), on, trust);
      return fmt::format("Use {}; {}.", of, trust);
    case TuneResult::too_few_pairs:
      if (t.bound <= q.max_rate)
        return fmt::format(
            "Not settled: {}; {}. The rate of {} may be at most {} (--max-other); more pairs (--pairs) may settle it.",
            of, trust, other_words(q.forbid), q.max_other);
      return fmt::format("Not settled: {}; {}, and {} was asked for. {}", of, trust, q.max_rate, pairs_to_show(q, t));
    case TuneResult::not_confirmed:
      return fmt::format(
          "Not settled: {}. It keeps {} at or under {} on the pairs that it was chosen on, but not on these. "
          "More pairs (--pairs) or a stricter --max-rate may lead to a choice that does.",
          of, words(q.forbid), q.max_rate);
    case TuneResult::not_useful:
      return fmt::format(
          "No {6} that was tried is good enough here. Among those that keep {0} at or under {1}, the one with the "
          "fewest {2} is {3}; {4}. The rate of {2} may be at most {5} (--max-other). The exact lane has no errors.",
          words(q.forbid), q.max_rate, other_words(q.forbid), of, trust, q.max_other, setting(q));
    case TuneResult::not_satisfiable:
      break;
  }
  return fmt::format(
      "No {} that was tried is good enough here: none keeps {} at or under {}. The one that comes nearest is {}. The "
      "exact lane has no errors.",
      setting(q), words(q.forbid), q.max_rate, of);
}

// Warns if the chosen value is 0 and errs differently from the next smallest value; otherwise empty. If
// triangles touch, a compared value may be exactly 0, which a tolerance of 0 may treat differently from a positive one.
std::string zero_words(const TuneQuestion& q, const Tuned& t) {
  if (t.curves.empty()) return "";
  const std::vector<PolicyErrors>& points = t.curves[0].points;
  if (analysis::tolerance_of(t.chosen) != 0 || points.size() < 2 || points[0].policy != t.chosen) return "";
  const PolicyErrors &zero = points[0], &least = points[1];
  if (zero.false_negative == least.false_negative && zero.false_positive == least.false_positive) return "";
  return fmt::format(
      "Zero behaves differently from the smallest tolerance: on the pairs that it was chosen on, {} has {}, and {} has "
      "{}.",
      policy_words(q, zero.policy), errors(zero), policy_words(q, least.policy), errors(least));
}

constexpr std::string_view kNotScaled = "A pair that would lose bits is left as it is.";

std::string power(int k) { return k > 0 ? fmt::format("grow by 2^{}", k) : fmt::format("shrink by 2^{}", -k); }

Json errors_json(const PolicyErrors& e) {
  Json row = {{"policy", e.policy}, {"pairs", e.pairs}};
  row.update(fuzz::counts_json(e, e.any_foreign()));
  row["fixed"] = e.fixed;
  row["broken"] = e.broken;
  return row;
}

Json epsilon_json(const TuneQuestion& q, const Tuned& tuned) {
  const subjects::Epsilon& e = q.source->epsilon;
  Json lines = Json::array();
  for (const subjects::SourcePlace& place : e.places) lines.push_back(place.line);
  const auto text = [](const std::string& raw) { return printable(raw); };
  Json json = {{"name", text(e.name)},
               {"written", text(e.written)},
               {"file", text(q.source->file.string())},
               {"lines", lines},
               {"chosen", tuned.chosen.empty() ? text(e.written)
                                               : subjects::written_value(e, analysis::tolerance_of(tuned.chosen))}};
  if (e.value) json["value"] = *e.value;
  if (!q.units.empty()) json["units"] = text(q.units);
  return json;
}

}  // namespace

std::vector<std::string> tuning_sentences(const TuneQuestion& question, const Tuned& tuned) {
  std::vector<std::string> result = {answer(question, tuned)};
  if (!tuned.chosen.empty()) {
    result.push_back(fmt::format("{} the same pairs show {}.",
                                 question.source ? "With " + policy_words(question, "") + "," : "Without a policy",
                                 errors(tuned.zero_confirmed)));
    const PolicyErrors& e = tuned.confirmed;
    result.push_back(fmt::format("Relocation: {} fixes {} of these pairs and breaks {} others.",
                                 policy_words(question, tuned.chosen), grouped(e.fixed), grouped(e.broken)));
    if (question.source && !question.units.empty()) {
      const double value = analysis::tolerance_of(tuned.chosen);
      result.push_back(fmt::format("Units: if {0} bounds a distance, its value is {1:g} {2}; if an area, {1:g} {2}^2.",
                                   printable(question.source->epsilon.name), value, printable(question.units)));
    }
  }
  if (question.source && !tuned.chosen.empty()) {
    if (const std::string text = zero_words(question, tuned); !text.empty()) result.push_back(text);
  }
  const auto changes_nothing = [](const PolicyErrors& point) { return point.changes_nothing(); };
  const std::string pairs =
      fmt::format("changes any verdict on the {} of the choice.", counted(tuned.zero.pairs, "pair"));
  if (question.source && std::all_of(tuned.curves[0].points.begin(), tuned.curves[0].points.end(), changes_nothing))
    result.push_back(fmt::format("Dead knob: no value of {} that was tried, from 0 up, {}",
                                 printable(question.source->epsilon.name), pairs));
  for (const std::string& site : tuned.dead)
    result.push_back(fmt::format("Dead knob: at {} no tolerance that was tried {}", site, pairs));
  const analysis::ScaleBreak& scale = tuned.scale;
  for (const auto& [k, at] : {std::pair{scale.up, scale.at_up}, {scale.down, scale.at_down}}) {
    if (k != 0)
      result.push_back(fmt::format("Scale break: if the pairs {}, {} more than double, to {} from {}. {}", power(k),
                                   doubled_words(question, scale.here, at), errors(at), errors(scale.here),
                                   kNotScaled));
  }
  if (!tuned.chosen.empty() && scale.up == 0 && scale.down == 0)
    result.push_back(fmt::format(
        "Scale: with {1}, {2} shown to double when the pairs are scaled by 2^±1, 2^±2, 2^±4 … 2^±{0}, on {3}. {4}",
        analysis::kMostScale, choice_words(question, tuned.chosen),
        question.forbid == Forbid::any ? "errors are not"
                                       : fmt::format("neither errors nor {} alone are", words(question.forbid)),
        counted(scale.here.pairs, "pair"), kNotScaled));
  for (const analysis::Interaction& i : tuned.interactions) {
    result.push_back(fmt::format(
        "Two sites: with {} alone, {} verdicts are wrong, with {} alone {}, and with both {}, on {} used to choose.",
        i.first, grouped(i.of_first.wrong()), i.second, grouped(i.of_second.wrong()), grouped(i.together.wrong()),
        counted(i.together.pairs, "pair")));
  }
  return result;
}

std::string tuning_table(const TuneQuestion& question, const Tuned& tuned, const Screen& screen) {
  TextTable table(
      {{std::string(setting(question)), Align::left}, {"fixes"}, {"breaks"}, {"false negatives"}, {"false positives"}});
  const auto add = [&](const PolicyErrors& e) {
    const bool none = e.policy.empty() && !question.source;
    table.add({none ? "none" : policy_words(question, e.policy), grouped(e.fixed), grouped(e.broken),
               grouped(e.false_negative), grouped(e.false_positive)});
  };
  add(tuned.zero);
  for (const PolicyErrors* best : analysis::best_of_curves(tuned.curves, question.forbid, question.max_rate)) {
    if (!best->changes_nothing()) add(*best);
  }
  return fmt::format("The best {}, on the {} pairs used to choose:\n{}",
                     question.source ? "value" : "tolerance of each kind and site", grouped(tuned.zero.pairs),
                     table.text(screen));
}

Json tuning_json(const TuneQuestion& question, const Tuned& tuned) {
  Json json = {{"lane", question.lane},
               {"forbid", kTuneForbids[static_cast<int>(question.forbid)]},
               {"max_rate", question.max_rate},
               {"max_other", question.max_other},
               {"chosen", tuned.chosen.empty() ? std::string(question.source ? kAsItIs : kZero) : tuned.chosen},
               {"result", kTuneResults[static_cast<int>(tuned.result)]},
               {"bound", tuned.bound},
               {"other_bound", tuned.other_bound},
               {"confirmed", errors_json(tuned.confirmed)},
               {"zero_confirmed", errors_json(tuned.zero_confirmed)},
               {"dead", tuned.dead},
               {"scale_break", Json::object()},
               {"interactions", Json::array()},
               {"zero", errors_json(tuned.zero)},
               {"curves", Json::array()},
               {"sentences", tuning_sentences(question, tuned)}};
  if (question.source) json["epsilon"] = epsilon_json(question, tuned);
  const analysis::ScaleBreak& scale = tuned.scale;
  for (const auto& [side, k, at] : {std::tuple{"up", scale.up, &scale.at_up}, {"down", scale.down, &scale.at_down}}) {
    if (k != 0)
      json["scale_break"][side] = {{"log2", k}, {"from", errors_json(scale.here)}, {"errors", errors_json(*at)}};
  }
  for (const analysis::Interaction& i : tuned.interactions)
    json["interactions"].push_back({{"first", errors_json(i.of_first)},
                                    {"second", errors_json(i.of_second)},
                                    {"together", errors_json(i.together)}});
  for (const analysis::Curve& curve : tuned.curves) {
    Json points = Json::array();
    for (const PolicyErrors& point : curve.points) points.push_back(errors_json(point));
    json["curves"].push_back({{"site", curve.site.empty() ? "all" : curve.site},
                              {"tolerance", curve.relative ? "rel" : "abs"},
                              {"points", std::move(points)}});
  }
  return json;
}

std::string tuning_figure(const TuneQuestion& question, const Tuned& tuned) {
  return tolerance_figure(
      fmt::format("Errors of {} against its tolerance", question.lane),
      question.source ? fmt::format("Share of wrong verdicts of {} against the value of {}; dashed: chosen",
                                    question.lane, printable(question.source->epsilon.name))
                      : fmt::format("Share of wrong verdicts of {} against its tolerance at all sites; dashed: chosen",
                                    question.lane),
      tuned.curves, tuned.chosen,
      {{"#0072b2", "false negatives", [](const PolicyErrors& e) { return e.false_negative; }},
       {"#d55e00", "false positives", [](const PolicyErrors& e) { return e.false_positive; }}});
}

}  // namespace graze::reports
