// SPDX-License-Identifier: Apache-2.0
#include "reports/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/text.h"
#include "fuzz/counts_json.h"
#include "reports/discrepancy_reading.h"
#include "reports/recorded_code.h"
#include "reports/tables.h"
#include "reports/terminal.h"
#include "strata/pair_source.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;
namespace {

using Name = std::pair<std::string, std::string>;  // lane and stratum

// A report's rates with their lanes and strata, in the report's order.
std::vector<std::pair<Name, Json>> rates_by_name(const Json& report) {
  std::vector<std::pair<Name, Json>> rates;
  for (const Json& row : report.at("rates")) {
    const Json& stratum = row.at("stratum");
    const std::string name =
        stratum.is_null() ? kAllStrata : report.at("strata").at(stratum.get<std::size_t>()).at("id");
    rates.push_back({{report.at("lanes").at(row.at("lane").get<std::size_t>()).at("id"), name}, row});
  }
  return rates;
}

// A report's strata by name. If meshes or hunts of one name have different pairs, their descriptions differ.
std::map<std::string, Json> strata_of(const Json& report) {
  std::map<std::string, Json> rows;
  for (const Json& row : report.at("strata")) rows[row.at("id")] = row;
  return rows;
}

double pairs_of(const Json& report) {
  double pairs = 0;
  for (const Json& row : report.at("strata")) pairs += row.at("pairs").get<double>();
  return pairs;
}

// Whether the stratum is in both reports with the same description.
bool is_common(const std::string& id, const std::map<std::string, Json>& l, const std::map<std::string, Json>& r) {
  return l.contains(id) && r.contains(id) && l.at(id).at("describes") == r.at(id).at("describes");
}

// Whether both reports have the same strata in the same shares. Otherwise, kinds and overall rates are not compared.
bool mixed_alike(const Json& l, const Json& r) {
  const auto of_l = strata_of(l), of_r = strata_of(r);
  const double all_l = pairs_of(l), all_r = pairs_of(r);
  return all_l > 0 && all_r > 0 && of_l.size() == of_r.size() &&
         std::all_of(of_l.begin(), of_l.end(), [&](const auto& stratum) {
           if (!is_common(stratum.first, of_l, of_r)) return false;
           const double in_l = stratum.second.at("pairs"), in_r = of_r.at(stratum.first).at("pairs");
           return std::abs(in_l / all_l - in_r / all_r) <= 1 / all_l + 1 / all_r;
         });
}

// The lanes of a subject.
std::set<std::string> lanes_of(const Json& report, const Json& subject) {
  std::set<std::string> lanes;
  for (const Json& lane : report.at("lanes")) {
    if (lane.at("algorithm") == subject) lanes.insert(lane.at("id"));
  }
  return lanes;
}

// The probability that at most `count` of the `all` errors of both campaigns fall into the first campaign, if an
// error is equally likely on every pair. pairs: the number of pairs of each campaign.
double chance_of_at_most(double count, double all, const double (&pairs)[2]) {
  const auto log_choose = [](double n, double k) {
    return std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
  };
  double term =
      std::exp(log_choose(pairs[0], count) + log_choose(pairs[1], all - count) - log_choose(pairs[0] + pairs[1], all));
  double sum = 0;
  for (double k = count; k >= 0 && all - k <= pairs[1] && term > 1e-6 * kLeastChance * (sum + 1e-6); --k) {
    sum += term;
    term *= k * (pairs[1] - all + k) / ((pairs[0] - k + 1) * (all - k + 1));  // the term of k - 1
  }
  return sum;
}

// Whether two rates differ: chance would hardly ever distribute the errors between the campaigns at least this
// unevenly.
// Reference: Fisher 1935, the exact test; twice the smaller of the two tails.
bool apart(const Json& l, const Json& r) {
  const double count[2] = {l.at("count"), r.at("count")}, of[2] = {l.at("of"), r.at("of")};
  if (of[0] == 0 || of[1] == 0) return false;
  const double all = count[0] + count[1], other_way[2] = {of[1], of[0]};
  const bool fewer = count[0] * of[1] <= count[1] * of[0];  // whether the first campaign has the lower rate
  return 2 * (fewer ? chance_of_at_most(count[0], all, of) : chance_of_at_most(count[1], all, other_way)) <
         kLeastChance;
}

// The smallest difference from the previous rate that counts as a change. A smaller difference could be due to chance.
// Nothing if there are too few pairs to show any difference.
std::optional<double> unseen_of(const Json& before, const Json& after) {
  const std::uint64_t of = after.at("of");
  const double share = before.at("share");
  if (of == 0 || before.at("of") == 0) return {};
  const auto differs = [&](std::uint64_t count) { return apart(before, to_json(share_of(count, of))); };
  const auto expected = std::min(of, static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(of))));
  std::uint64_t low = expected, high = of;  // find the smallest count above the expected one that differs
  if (differs(high)) {
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      differs(middle) ? high = middle : low = middle + 1;
    }
    return static_cast<double>(high) / static_cast<double>(of) - share;
  }
  low = 0, high = expected;  // find the largest count below it that differs
  if (!differs(low)) return {};
  while (low + 1 < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    differs(middle) ? low = middle : high = middle;
  }
  return share - static_cast<double>(low) / static_cast<double>(of);
}

// About the rates that did not change: "differences under 0.02 % to 1.2 % (by rate and pairs) might not be seen". A
// kind of error is a share of fewer pairs, so a smaller difference in it can be seen.
std::string power_words(const Json& rates) {
  std::optional<double> least, most;
  std::size_t blind = 0;
  for (const Json& row : rates) {
    if (row.at("changed") == true) continue;
    const Json& unseen = row.at("unseen");
    if (unseen.is_null()) {
      ++blind;
      continue;
    }
    const double value = unseen;
    least = std::min(least.value_or(value), value);
    most = std::max(most.value_or(value), value);
  }
  const std::string none =
      blind == 0 ? "" : fmt::format("; {} of the rates have too few pairs to show any", grouped(blind));
  if (!least) return blind == 0 ? "" : "the campaigns have too few pairs to show a difference";
  const std::string from = rounded_up(100 * *least, 2), to = rounded_up(100 * *most, 2);
  return fmt::format("differences under {} might not be seen{}",
                     from == to ? to + " %" : fmt::format("{} % to {} % (by rate and pairs)", from, to), none);
}

// The kinds of error whose rates changed: [{"error": "false positives", "before", "after"}].
template <class Changed>
Json changed_errors(const Json& before, const Json& after, Changed changed) {
  Json rows = Json::array();
  for (const fuzz::CountField& field : fuzz::kCountFields) {
    const auto share_in = [&](const Json& rates) {
      const Json found = rates.value(field.key, Json(0));
      return found.is_object() ? found : to_json(share_of(found, rates.at("wrong").at("of")));
    };
    const Json old = share_in(before), now = share_in(after);
    if (!changed(old, now)) continue;
    std::string words = field.key;
    std::replace(words.begin(), words.end(), '_', ' ');
    rows.push_back({{"error", words.starts_with("false") ? words + 's' : words}, {"before", old}, {"after", now}});
  }
  return rows;
}

// Kinds that `others` lacks although at least `least` of their signatures were expected there. A signature names all
// wrong lanes of its subject, so only subjects with the same lanes in both reports are compared.
Json only_in(const Json& kinds, const Json& others, const Json& report, const Json& other_report, double least) {
  const double pairs = pairs_of(report), pairs_of_others = pairs_of(other_report);
  std::set<std::string> known;
  for (const Json& kind : others) known.insert(kind.at("key"));
  Json rows = Json::array();
  for (const Json& kind : kinds) {
    const double expected = kind.at("signatures").get<double>() * std::min(1.0, pairs_of_others / pairs);
    if (known.contains(kind.at("key")) || expected < least) continue;
    if (lanes_of(report, kind.at("subject")) != lanes_of(other_report, kind["subject"])) continue;
    rows.push_back({{"key", kind.at("key")}, {"signatures", kind.at("signatures")}, {"count", kind.at("pairs")}});
  }
  return rows;
}

// The kinds of subjects with a changed verdict. Kinds of other subjects may also differ, because `graze minimize`
// finds the cause on one pair of each signature, and not always on the same pair.   verdicts: null if unknown.
Json of_changed(const Json& kinds, const Json& verdicts) {
  if (verdicts.is_null()) return kinds;
  std::set<std::string> subjects;
  for (const Json& row : verdicts) {
    const std::string lane = row.at("lane");
    if (row.at("known") != "same") subjects.insert(lane.substr(0, lane.find('/')));
  }
  Json rows = Json::array();
  for (const Json& kind : kinds) {
    const std::string key = kind.at("key");
    if (subjects.contains(key.substr(0, key.find('/')))) rows.push_back(kind);
  }
  return rows;
}

std::set<std::string> ids_of(const Json& rows) {
  std::set<std::string> ids;
  for (const Json& row : rows) ids.insert(row.at("id"));
  return ids;
}

std::string list(const std::set<std::string>& l, const std::set<std::string>& r) {
  std::vector<std::string> only;
  std::set_difference(l.begin(), l.end(), r.begin(), r.end(), std::back_inserter(only));
  if (only.size() > 3) return fmt::format("{}, {} and {} more", only[0], only[1], only.size() - 2);
  return only.empty() ? "none" : fmt::format("{}", fmt::join(only, ", "));
}

// "Not compared: …" for lanes that only one campaign has; empty if all lanes are in both.
std::string one_sided_lanes(const Json& before, const Json& after) {
  const std::set<std::string> l = ids_of(before.at("lanes")), r = ids_of(after.at("lanes"));
  std::vector<std::string> lanes;
  std::set_symmetric_difference(l.begin(), l.end(), r.begin(), r.end(), std::back_inserter(lanes));
  if (lanes.empty()) return "";
  std::set<std::string> subjects;
  for (const std::string& id : lanes) subjects.insert(id.substr(0, id.find('/')));
  return fmt::format(
      "Not compared: lanes of {}, which only one campaign has; two versions of one code are compared if "
      "they have the same name.",
      fmt::join(subjects, ", "));
}

std::string scene_of(const Json& run) {
  return run.contains("scene") && !run["scene"].is_null() ? run["scene"].get<std::string>() : "none";
}

// The hash at the end of a scene's name, such as arm.toml#0123456789abcdef. It does not depend on the file's folder.
std::string content_of(const std::string& scene) { return scene.substr(scene.rfind('#') + 1); }

// The number of the lane's changed verdicts, in words.   verdicts: null if unknown.
std::string changes_of(const std::string& lane, const Json& verdicts) {
  if (verdicts.is_null()) return "the number of changed verdicts is not known";
  std::uint64_t least = 0, most = 0;
  for (const Json& row : verdicts) {
    if (row.at("lane") != lane) continue;
    least += row.at("least").get<std::uint64_t>();
    most += row.at("most").get<std::uint64_t>();
  }
  const std::string number = least == most ? grouped(most) : fmt::format("{} to {}", grouped(least), grouped(most));
  return fmt::format("{} {}", number, most == 1 ? "verdict differs" : "verdicts differ");
}

// A sentence for each toolchain and scalar for which the compilers of the two campaigns fuse different products.
std::vector<std::string> plan_differences(const Json& then, const Json& now, const Json& verdicts) {
  std::vector<std::string> sentences;
  for (const Json& old : then.value("subjects", Json::array())) {
    for (const Json& found : now.value("subjects", Json::array())) {
      if (old.at("name") != found.at("name")) continue;
      const Json plans_then = old.value("contraction", Json::object()),
                 plans = found.value("contraction", Json::object());
      for (const auto& [toolchain, of] : plans_then.items()) {
        if (!plans.contains(toolchain)) continue;
        for (const auto& [scalar, plan] : of.items()) {
          const Json other = plans[toolchain].value(scalar, plan);
          if (other == plan) continue;
          const std::string of_scalar = text_at(old, "name") + '/' + printable(scalar);
          sentences.push_back(
              fmt::format("{} ({}): the compiler fuses other products (plan {} before, {} after); {}.", of_scalar,
                          printable(toolchain), text_at(plan, "plan"), text_at(other, "plan"),
                          changes_of(old.at("name").get<std::string>() + '/' + scalar + '/' + toolchain, verdicts)));
        }
      }
    }
  }
  return sentences;
}

bool has_contracted_lane(const Json& report) {
  const std::set<std::string> ids = ids_of(report.at("lanes"));
  return std::any_of(ids.begin(), ids.end(), [](const std::string& id) { return id.find("/cpu-fma") != id.npos; });
}

// Describes how the campaigns differ, one sentence for each difference.
Json differences_of(const Json& after, const Json& before, const Json& verdicts) {
  Json rows = Json::array();
  const Json &now = after.at("run"), &then = before.at("run");
  for (const auto& [what, words] : {std::pair("seed", "seed differs"), {"pairs", "number of pairs differs"}}) {
    if (now.at(what) != then.at(what))
      rows.push_back(fmt::format("The {}: {} before, {} after.", words, grouped(then.at(what)), grouped(now.at(what))));
  }
  if (content_of(scene_of(now)) != content_of(scene_of(then)))
    rows.push_back(fmt::format("The scene differs, so the same stratum draws other pairs: {} before, {} after.",
                               scene_of(then), scene_of(now)));
  for (const char* what : {"strata", "lanes"}) {
    const std::set<std::string> l = ids_of(before.at(what)), r = ids_of(after.at(what));
    if (l != r)
      rows.push_back(
          fmt::format("The {0} differ; only {0} of both campaigns are compared. Only before: {1}; only after: {2}.",
                      what, list(l, r), list(r, l)));
  }
  const auto now_drawn = strata_of(after), then_drawn = strata_of(before);
  for (const auto& [id, row] : now_drawn) {
    if (then_drawn.contains(id) && !is_common(id, now_drawn, then_drawn))
      rows.push_back(fmt::format("The stratum {} differs and is not compared: {} before, {} after.", id,
                                 then_drawn.at(id).at("describes").get<std::string>(),
                                 row.at("describes").get<std::string>()));
  }
  for (const std::string& sentence : code_differences(then, now)) rows.push_back(sentence);
  for (const std::string& sentence : plan_differences(then, now, verdicts)) rows.push_back(sentence);
  const auto compiler = [](const Json& run) { return printable(run.at("build").value("compiler", "")); };
  if (compiler(now) != compiler(then) && has_contracted_lane(before) && has_contracted_lane(after))
    rows.push_back(
        fmt::format("The compiler of Graze differs, so cpu-fma lanes may fuse different products: {} before, {} after.",
                    compiler(then), compiler(now)));
  const auto commit = [](const Json& run) { return run.at("build").at("commit").get<std::string>(); };
  if (commit(now) != commit(then))
    rows.push_back(fmt::format("The build differs: {} before, {} after.", commit(then), commit(now)));
  return rows;
}

}  // namespace

bool same_pairs(const Json& before, const Json& after) {
  const Json &run_l = before.at("run"), &run_r = after.at("run");
  const auto same = [&](const char* what) { return run_l.value(what, Json()) == run_r.value(what, Json()); };
  return same("seed") && same("pairs") && run_l.value("complete", true) && run_r.value("complete", true) &&
         content_of(scene_of(run_l)) == content_of(scene_of(run_r)) && before.at("strata") == after.at("strata") &&
         !strata_of(before).contains("hunt") && !strata_of(before).contains("hunt/f64");
}

void add_comparison(Json& report, const Json& before, const Json& kinds, const Json& kinds_before,
                    const Json& verdicts) {
  const auto then = rates_by_name(before);
  const std::map<Name, Json> by_name(then.begin(), then.end());
  const auto now_drawn = strata_of(report), then_drawn = strata_of(before);
  const bool alike = mixed_alike(report, before), same = same_pairs(before, report);
  const auto is_changed = [same](const Json& l, const Json& r) {
    return same ? l.at("count") != r.at("count") : apart(l, r);
  };
  Json rows = Json::array();
  std::size_t changed = 0;
  std::map<std::string, std::size_t> changed_by_error;
  for (const auto& [name, now] : rates_by_name(report)) {
    const auto old = by_name.find(name);
    const bool compared = name.second == kAllStrata ? alike : is_common(name.second, now_drawn, then_drawn);
    if (old == by_name.end() || !compared) continue;
    const Json errors = changed_errors(old->second, now, is_changed);
    for (const Json& row : errors) ++changed_by_error[row.at("error")];
    const Json &wrong_before = old->second.at("wrong"), &wrong = now.at("wrong");
    const bool row_changed = !errors.empty() || is_changed(wrong_before, wrong);
    changed += row_changed;
    rows.push_back({{"lane", name.first},
                    {"stratum", name.second},
                    {"before", wrong_before},
                    {"after", wrong},
                    {"changed", row_changed},
                    {"errors", errors}});
    if (same) continue;
    const std::optional<double> unseen = unseen_of(wrong_before, wrong);
    rows.back()["unseen"] = unseen ? Json(*unseen) : Json();
  }
  const bool kinds_known = !kinds.is_null() && !kinds_before.is_null(), kinds_compared = kinds_known && alike;
  const double least = same ? 1 : kLeastSignatures;  // on the same pairs, no difference is due to chance
  const auto only = [&](const Json& some, const Json& others, const Json& of, const Json& of_others) {
    return kinds_compared ? of_changed(only_in(some, others, of, of_others, least), verdicts) : Json::array();
  };
  const Json gained = only(kinds, kinds_before, report, before), lost = only(kinds_before, kinds, before, report);
  const std::string of_kinds =
      !kinds_compared ? "kinds of failure are not compared"
      : gained.empty() && lost.empty()
          ? fmt::format("no kind of failure{} came or went",
                        same ? "" : fmt::format(" with at least {} expected signatures", kLeastSignatures))
          : fmt::format("{} of failure came, {} went", counted(gained.size(), "kind"), lost.size());
  std::string headline;
  if (rows.empty()) {
    headline = "Nothing to compare: the campaigns have no lane or no stratum in common.";
  } else if (!verdicts.is_null()) {
    headline = paired_headline(verdicts) + "; " + of_kinds + ".";
  } else if (changed == 0 && gained.empty() && lost.empty()) {
    headline = fmt::format(
        "None of {} rates changed, and {}; {}.", grouped(rows.size()), of_kinds,
        same ? "single verdicts are not compared, because a campaign's database is missing" : power_words(rows));
  } else {
    std::vector<std::string> errors;
    for (const auto& [error, count] : changed_by_error)
      errors.push_back(fmt::format("{} in {}", error, grouped(count)));
    const std::string power = same ? "" : power_words(rows);
    headline = fmt::format("Changed: {} of {} rates{}; {}{}.", grouped(changed), grouped(rows.size()),
                           errors.empty() ? "" : fmt::format(" ({})", fmt::join(errors, ", ")), of_kinds,
                           power.empty() ? "" : "; in the other rates, " + power);
  }
  if (const std::string one_sided = one_sided_lanes(before, report); !one_sided.empty()) headline += ' ' + one_sided;
  Json differences = differences_of(report, before, verdicts);
  if (!alike)
    differences.push_back(
        "Rates over all strata and kinds of failure are not compared: the campaigns have different strata, or the same "
        "in different shares.");
  if (!kinds_known)
    differences.push_back("Kinds of failure are not compared: run `graze minimize` on both campaigns first.");
  report["compare"] = {
      {"other", before.at("run")}, {"headline", headline}, {"differences", differences},       {"rates", rows},
      {"gained", gained},          {"lost", lost},         {"kinds_compared", kinds_compared}, {"verdicts", verdicts}};
}

}  // namespace graze::reports
