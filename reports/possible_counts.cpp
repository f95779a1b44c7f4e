// SPDX-License-Identifier: Apache-2.0
#include "reports/possible_counts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "analysis/pareto.h"
#include "analysis/tuning.h"
#include "core/lanes/lanes.h"
#include "core/margin/bucket.h"
#include "core/pair.h"
#include "core/text.h"
#include "core/wilson.h"
#include "fuzz/campaign/lane_costs.h"
#include "fuzz/counts_json.h"
#include "reports/comparison.h"
#include "reports/extremes.h"
#include "reports/failure_cards.h"
#include "reports/tables.h"
#include "reports/tuning.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// Throws: std::runtime_error that names the expectation and shows the part of the file.
void expect(bool possible, const std::string& what, const Json& part) {
  if (!possible) throw std::runtime_error(fmt::format("expected {}, found {}", what, shown(part.dump())));
}

// Checks that every share in `part` agrees with its counts.
void expect_shares(const Json& part) {
  if (part.is_object() && part.contains("count") && part.contains("of") && part.contains("share")) {
    const std::uint64_t count = part["count"], of = part["of"];
    expect(count <= of && part == to_json(share_of(count, of)), fmt::format("a share of at most {} pairs", of), part);
  } else if (part.is_structured()) {
    for (const Json& inner : part) expect_shares(inner);
  }
}

// Checks that the upper bound of a rate is not below the observed rate.
void expect_bound(const Json& bound, std::uint64_t count, std::uint64_t of, const Json& part) {
  const double least = of == 0 ? 1 : std::max(static_cast<double>(count) / static_cast<double>(of), bound_of_none(of));
  expect(bound >= (1 - 1e-9) * least && bound <= 1, fmt::format("a bound for {} of {} pairs", count, of), part);
}

struct Drawn {
  std::uint64_t pairs = 0, intersects = 0;
};

// The strata of a group, or all strata if it is null.
std::vector<std::size_t> strata_in(const Json& report, const Json& group) {
  if (!group.is_null())
    return report.at("groups").at(group.get<std::size_t>()).at("strata").get<std::vector<std::size_t>>();
  std::vector<std::size_t> all(report.at("strata").size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// The pairs of a stratum, of a group, or of all strata if both are null.
Drawn drawn_of(const Json& report, const Json& stratum, const Json& group = {}) {
  if (!stratum.is_null()) {
    const Json& row = report.at("strata").at(stratum.get<std::size_t>());
    return {row.at("pairs"), row.at("intersects")};
  }
  Drawn sum;
  for (const std::size_t place : strata_in(report, group)) {
    const Drawn one = drawn_of(report, place);
    sum.pairs += one.pairs;
    sum.intersects += one.intersects;
  }
  return sum;
}

void expect_possible_rates(const Json& report) {
  // For each lane: its counts over all strata together, and the sum of its counts over the strata.
  std::map<std::string, std::pair<Counts, Counts>> of_lanes;
  for (const Json& row : report.at("rates")) {
    const Drawn of = drawn_of(report, row.at("stratum"));
    Counts counts{row.at("false_positive").at("count"), row.at("false_negative").at("count")};
    bool few = true;
    for (const fuzz::CountField& field : fuzz::kCountFields) {
      if (row.contains(field.key) && row[field.key].is_number()) counts.*field.count = row[field.key];
      few = few && counts.*field.count <= of.pairs;
    }
    const Json& differs = row.at("differs_from_cpu");
    expect(few && row.at("wrong").at("count") == counts.wrong() && row["wrong"].at("of") == of.pairs &&
               row["false_negative"].at("of") == of.intersects &&
               row["false_positive"].at("of") == of.pairs - of.intersects &&
               (differs.is_null() || differs.at("of") == of.pairs) &&
               row.value("stored", std::uint64_t{0}) <= counts.wrong() && counts.not_true() <= of.pairs,
           fmt::format("rates that add up to {} pairs", of.pairs), row);
    auto& [together, sum] = of_lanes[row.at("lane").dump()];
    (row.at("stratum").is_null() ? together : sum) += counts;
  }
  for (const auto& [lane, counts] : of_lanes)
    expect(counts.first == counts.second, "rates of all strata together that are the sums of the strata's rates", lane);
  for (const Json& row : report.at("group_rates")) {
    expect(row.at("wrong").at("of") == drawn_of(report, nullptr, row.at("group")).pairs,
           "as many pairs as its group has", row);
    if (!row.contains("false_positive")) continue;
    expect(
        row["false_positive"].at("of").get<std::uint64_t>() + row.at("false_negative").at("of").get<std::uint64_t>() ==
                row["wrong"]["of"] &&
            row["false_positive"].at("count").get<std::uint64_t>() +
                    row["false_negative"].at("count").get<std::uint64_t>() <=
                row["wrong"].at("count"),
        "errors and pairs that add up", row);
  }
  for (const Json& rows : report.at("side_by_side")) {
    for (const Json& row : rows.at("strata")) {
      for (const char* field : {"left_wrong", "right_wrong", "differs"}) {
        expect(row.at(field).is_null() || row[field].at("of") == drawn_of(report, row.at("stratum")).pairs,
               "as many pairs as its stratum has", row);
      }
    }
  }
}

// Checks that the lane's differences from cpu, summed over margins, equal those in its rates.
void expect_differences(const Json& report, const Json& row) {
  for (const Json& rate : report.at("rates")) {
    if (rate.at("lane") != row.at("lane") || rate.at("stratum") != row.at("stratum")) continue;
    const Json& differs = rate.at("differs_from_cpu");
    std::uint64_t sum = 0;
    for (const Json& point : row.at("points")) {
      expect(point.contains("differs") != differs.is_null(), "differences from cpu at all margins or at none", point);
      if (differs.is_null()) continue;
      expect(point["differs"].at("of") == point.at("wrong").at("of"), "differences on the pairs at this margin", point);
      sum += point["differs"].at("count").get<std::uint64_t>();
    }
    expect(differs.is_null() || differs.at("count") == sum, fmt::format("{} verdicts that differ from cpu", sum), rate);
  }
}

// Checks that an extreme's origin, ratios and words agree with its cells.
void expect_extremes(const Json& row) {
  Json again = row;
  add_right_range(again);
  expect(again == row, "the ratios and words that follow from its cells", row);
}

// Reads the counts at a lane's margins.   Throws: std::runtime_error if a margin is invalid or occurs twice.
StratumCounts counts_at(const Json& points) {
  StratumCounts counts;
  for (const Json& point : points) {
    const Json& exponent = point.at("exponent");
    Bucket bucket = 0;
    if (!exponent.is_null()) bucket = make_bucket(point.at("side") == "disjoint" ? 1 : -1, exponent.get<int>());
    expect(point.at("side") == side_of(bucket) && (bucket == 0 || exponent == exponent_of(bucket)),
           "a side and an exponent of margins", point);
    const WrongCounts wrong{point.at("wrong").at("of"), {point["wrong"].at("count").get<std::uint64_t>()}, {}};
    expect(counts.margins.emplace(bucket, wrong).second, "each margin once", point);
  }
  return counts;
}

// Checks that the thresholds over all strata agree with the margins.
void expect_thresholds(const Json& report, const Json& margins) {
  const StratumCounts counts = counts_at(margins.at("points"));
  const bool one_stratum = report.at("strata").size() == 1;
  for (const Json& row : report.at("thresholds")) {
    const bool of_all = row.at("group").is_null() && (row.at("stratum").is_null() || one_stratum);
    if (row.at("lane") != margins.at("lane") || !of_all) continue;
    for (const auto& [name, side] : {std::pair("disjoint", 1), {"intersects", -1}})
      expect(row.at(name) == to_json(threshold(counts, 0, side)), "the threshold that follows from the margins",
             row[name]);
  }
}

// Checks the counts by margin, scale and offset.
void expect_possible_curves(const Json& report) {
  const auto pairs_of = [](const Json& cells) {
    std::uint64_t pairs = 0;
    for (const Json& cell : cells) pairs += cell.at("wrong").at("of").get<std::uint64_t>();
    return pairs;
  };
  for (const Json& row : report.at("margins")) {
    const std::uint64_t pairs = drawn_of(report, row.at("stratum")).pairs;
    expect(pairs_of(row.at("points")) == pairs, fmt::format("points of {} pairs", pairs), row);
    expect_differences(report, row);
    expect_thresholds(report, row);
  }
  for (const Json& row : report.at("extremes")) {
    const std::uint64_t pairs = drawn_of(report, nullptr).pairs;
    expect(pairs_of(row.at("cells")) <= pairs, fmt::format("cells of at most {} pairs", pairs), row);
    expect_extremes(row);
  }
  for (const Json& row : report.at("thresholds")) {
    const Drawn of = drawn_of(report, row.at("stratum"), row.at("group"));
    for (const auto& [name, pairs] : {std::pair("disjoint", of.pairs - of.intersects), {"intersects", of.intersects}}) {
      const Json& side = row.at(name);
      const std::uint64_t above = side.at("above");
      const bool found = !side.at("exponent").is_null();
      expect(above <= pairs && found == (above > 0) && (!found || side["exponent"] <= side.at("largest")),
             fmt::format("a threshold of at most {} pairs", pairs), row);
      expect_bound(side.at("bound"), 0, above, row);
    }
  }
}

void expect_possible_failures(const Json& report) {
  const std::uint64_t pairs = drawn_of(report, nullptr).pairs, signatures = report.at("signature_count");
  expect(report.at("signatures").size() == std::min<std::uint64_t>(signatures, kMostSignatures),
         "as many signatures as are listed", report["signature_count"]);
  for (const Json& row : report["signatures"]) {
    const std::uint64_t count = row.at("count");
    expect(count > 0 && count <= pairs && row.at("share") == to_json(share_of(count, pairs)).at("share"),
           fmt::format("a share of {} pairs", pairs), row);
    for (const Json& card : row.at("cards")) report.at("cards").at(card.get<std::size_t>());
  }
  std::set<std::string> strata;
  for (const Json& row : report.at("strata")) strata.insert(row.at("id"));
  std::set<std::pair<std::string, std::string>> lanes;  // subject and id
  for (const Json& row : report.at("lanes")) lanes.emplace(row.at("algorithm"), row.at("id"));
  for (const Json& card : report.at("cards")) {
    const Json& kind = card.at("kind");
    const std::uint64_t of_kind = kind.at("pairs");
    std::uint64_t by_margin = 0;
    bool possible = of_kind <= pairs && kind.at("intersecting") <= of_kind && kind.at("signatures") <= signatures &&
                    kind.at("settled").size() == 2 && kind["settled"][0] <= kind["settled"][1] &&
                    kind["settled"][1] <= kind["signatures"].get<std::uint64_t>() * kind.at("lanes").size();
    for (const Json& count : kind.at("margins")) by_margin += count.get<std::uint64_t>();
    for (const auto& [name, count] : kind["margins"].items()) possible = possible && buckets_by_name().contains(name);
    for (const auto& [name, count] : kind.at("strata").items()) possible = possible && strata.contains(name);
    for (const Json& lane : kind.at("lanes")) possible = possible && lanes.contains({kind.at("subject"), lane});
    for (const char* by : {"margins", "strata"}) {
      for (const Json& count : kind.at(by)) possible = possible && count <= of_kind;
    }
    possible = possible && (card.at("coordinates") == name(Scalar::f32) || card["coordinates"] == name(Scalar::f64));
    for (const char* form : {"decimal", "hex", "value"})
      possible = possible && card.at("pair").at(form).size() == kCoordinates;
    for (const char* part : {"contact", "planes_line"}) {
      for (const Json& point : card.at("drawing").at(part)) possible = possible && point.size() == 3;
    }
    expect(possible && by_margin == of_kind, fmt::format("a kind of failure of at most {} pairs", pairs), kind);
  }
}

// Checks that every lane index in `part` is valid.
void expect_lanes(const Json& part, std::size_t lanes) {
  for (const auto& [name, inner] : part.items()) {
    if (part.is_object() && (name == "lane" || name == "left" || name == "right") && inner.is_number())
      expect(inner < lanes, fmt::format("the index of one of {} lanes", lanes), part);
    if (inner.is_structured()) expect_lanes(inner, lanes);
  }
}

// Checks the results of `graze tune` and `graze pareto`: errors do not exceed the pairs, and quartiles are in order.
void expect_possible_errors(const Json& part) {
  if (part.is_object() && part.contains("declined") && part.contains("pairs")) {
    const std::uint64_t pairs = part["pairs"];
    bool possible = true;
    for (const char* field : {"false_positive", "false_negative", "declined", "fixed", "broken"})
      possible = possible && part.value(field, std::uint64_t{0}) <= pairs;
    expect(possible && fuzz::counts_of(part).not_right() <= pairs, fmt::format("errors on at most {} pairs", pairs),
           part);
  } else if (part.is_object() && part.contains("middle")) {
    expect(0 < part.at("low") && part["low"] <= part["middle"] && part["middle"] <= part.at("high"),
           "quartiles in order", part);
  } else if (part.is_structured()) {
    for (const Json& inner : part) expect_possible_errors(inner);
  }
}

void expect_lane(const Json& id) {
  expect(parse_lane_name(id.get<std::string>()).has_value(), "the name of a lane", id);
}

// Checks that the bound is the one that `graze tune` and `graze pareto` compute.
void expect_upper_bound(const Json& bound, std::uint64_t count, std::uint64_t of) {
  const double expected = analysis::upper_bound(count, of);
  expect(std::abs(bound.get<double>() - expected) <= 1e-9 * expected,
         fmt::format("{:.17g} as the bound for {} of {} pairs", expected, count, of), bound);
}

analysis::PolicyErrors errors_of(const Json& row) {
  analysis::PolicyErrors errors;
  static_cast<Counts&>(errors) = fuzz::counts_of(row);
  errors.policy = row.at("policy");
  errors.pairs = row.at("pairs");
  errors.fixed = row.at("fixed");
  errors.broken = row.at("broken");
  return errors;
}

// Checks that the fixed and broken pairs account for the difference between the errors with and without the policy.
void expect_relocation(const Json& row, const Json& without) {
  const analysis::PolicyErrors errors = errors_of(row), zero = errors_of(without);
  expect(
      errors.pairs == zero.pairs && errors.fixed <= zero.not_right() && errors.broken <= errors.not_right() &&
          zero.not_right() - errors.fixed == errors.not_right() - errors.broken,
      fmt::format("errors on {} of {} pairs, minus the fixed and plus the broken ones", zero.not_right(), zero.pairs),
      row);
}

void expect_relocations(const Json& tuned) {
  const Json &zero = tuned.at("zero"), &zero_confirmed = tuned.at("zero_confirmed");
  for (const Json* without : {&zero, &zero_confirmed}) {
    const analysis::PolicyErrors errors = errors_of(*without);
    expect(errors.policy.empty() && errors.changes_nothing(), "errors without a policy", *without);
  }
  expect_relocation(tuned.at("confirmed"), zero_confirmed);
  std::set<std::pair<std::string, std::string>> curves;
  for (const Json& curve : tuned.at("curves")) {
    expect(curves.emplace(curve.at("site"), curve.at("tolerance")).second, "each curve once", curve.at("site"));
    for (const Json& point : curve.at("points")) expect_relocation(point, zero);
  }
  for (const Json& row : tuned.at("interactions")) {
    for (const char* which : {"first", "second", "together"}) expect_relocation(row.at(which), zero);
  }
  const std::uint64_t most = tuned.at("confirmed").at("pairs");
  for (const auto& [side, row] : tuned.at("scale_break").items()) {
    const analysis::PolicyErrors errors = errors_of(row.at("errors")), from = errors_of(row.at("from"));
    const auto can_be = [&](const analysis::PolicyErrors& of) {
      return of.policy == tuned.at("chosen").get<std::string>() && of.fixed <= of.pairs - of.not_right() &&
             of.broken <= of.not_right();
    };
    const int log2 = row.at("log2");
    expect((side == "up" ? log2 > 0 : log2 < 0) && std::abs(log2) <= analysis::kMostScale && errors.pairs <= most &&
               from.pairs == errors.pairs && can_be(errors) && can_be(from),
           fmt::format("errors of the choice at another scale, on at most {} pairs", most), row);
  }
}

template <class Enumeration, std::size_t kCount>
Enumeration among(const std::string_view (&names)[kCount], const Json& name) {
  const auto found = std::find(std::begin(names), std::end(names), name.get_ref<const std::string&>());
  expect(found != std::end(names), fmt::format("one of {}", fmt::join(names, ", ")), name);
  return static_cast<Enumeration>(found - std::begin(names));
}

// Checks that the choice, its result and the dead sites agree with the counts.
void expect_choice(const Json& tuned) {
  const auto forbid = among<analysis::Forbid>(kTuneForbids, tuned.at("forbid"));
  const double max_rate = tuned.at("max_rate");
  const std::string without(tuned.contains("epsilon") ? kAsItIs : kZero);
  const std::string chosen = tuned.at("chosen") == without ? "" : tuned["chosen"].get<std::string>();
  const analysis::PolicyErrors confirmed = errors_of(tuned.at("confirmed")), zero = errors_of(tuned.at("zero"));
  expect(confirmed.policy == chosen, "errors of the chosen policy", tuned["confirmed"]);
  std::optional<analysis::PolicyErrors> chosen_on;
  if (chosen.empty()) chosen_on = zero;
  std::vector<analysis::PolicyErrors> others = {zero};
  std::vector<std::string> sites;
  std::set<std::string> live = {"all"};
  for (const Json& curve : tuned.at("curves")) {
    const std::string site = curve.at("site");
    if (site != "all" && std::find(sites.begin(), sites.end(), site) == sites.end()) sites.push_back(site);
    for (const Json& point : curve.at("points")) {
      others.push_back(errors_of(point));
      if (!others.back().changes_nothing()) live.insert(site);
      if (!chosen_on && others.back().policy == chosen) chosen_on = others.back();
    }
  }
  std::erase_if(sites, [&](const std::string& site) { return live.contains(site); });
  expect(tuned.at("dead") == Json(sites), "the sites at which nothing changes as dead sites", tuned["dead"]);
  expect(chosen_on.has_value(), "a point of the curves as the choice", tuned["chosen"]);
  const analysis::PolicyRank rank = analysis::rank(*chosen_on, forbid, max_rate);
  expect(std::none_of(others.begin(), others.end(),
                      [&](const auto& other) { return analysis::rank(other, forbid, max_rate) < rank; }),
         "the best policy of the curves as the choice", tuned["chosen"]);
  expect_upper_bound(tuned.at("bound"), forbidden(confirmed, forbid), confirmed.pairs);
  const auto result = among<analysis::TuneResult>(kTuneResults, tuned.at("result"));
  if (forbid == analysis::Forbid::any) {
    expect(tuned.at("other_bound") == 0, "0, because all errors are forbidden", tuned["other_bound"]);
  } else {
    expect_upper_bound(tuned.at("other_bound"), confirmed.wrong() - forbidden(confirmed, forbid), confirmed.pairs);
  }
  const auto expected = result_of(*chosen_on, confirmed, forbid, max_rate, tuned.at("max_other"));
  expect(result == expected, fmt::format("'{}'", kTuneResults[static_cast<int>(expected)]), tuned["result"]);
}

// Checks that all rows have costs on the host, or all have costs on a device, whose fields differ.
void expect_costs_of_kind(const Json& row, bool on_device) {
  for (const char* field : {"resident", "with_copies", "registers", "local_bytes", "active_threads"})
    expect(row.contains(field) == on_device, fmt::format("{} for all lanes or for none", field), row);
  for (const char* field : {"in_cache", "from_memory"})
    expect(row.contains(field) != on_device, fmt::format("{} for all lanes or for none", field), row);
  // If a user's code takes only blocks of pairs, there is no cost of a call of one pair.
  const Lane* lane = find_lane(row.at("lane").get<std::string>());
  expect(on_device || !lane || lane->foreign || row.contains("one_a_call"), "the cost of a call of one pair", row);
}

// Checks which lanes are dominated. Rounding keeps the order of costs, but may make different costs equal.
void expect_domination(const Json& row, const Json& lanes) {
  const auto cost = [](const Json& lane, const char* quartile) -> double {
    return lane.at(lane.contains("resident") ? "resident" : "in_cache").at(quartile);
  };
  const auto errors = [](const Json& lane) { return fuzz::counts_of(lane.at("errors")).not_true(); };
  const bool dominated = row.at("dominated");
  const auto is_cheaper = [&](const Json& other) {
    const bool same_errors = errors(other) == errors(row);
    const double others = cost(other, same_errors ? "high" : "middle"), own = cost(row, same_errors ? "low" : "middle");
    return dominated ? others <= own : others < own;
  };
  expect(std::any_of(lanes.begin(), lanes.end(),
                     [&](const Json& other) {
                       return &other != &row && errors(other) <= errors(row) && is_cheaper(other);
                     }) == dominated,
         dominated ? "a lane that none dominates" : "a lane that another dominates", row.at("dominated"));
}

// Checks the toolchain map against the lanes and their rates.
void expect_possible_map(const Json& map, const Json& report) {
  const std::vector<std::string> variants = map.at("variants");
  const auto is_variant = [&](const Json& name) {
    return std::find(variants.begin(), variants.end(), name.get<std::string>()) != variants.end();
  };
  expect(is_variant(map.at("reference")), "a reference among the variants", map["reference"]);
  for (const Json& group : map.at("agree")) {
    for (const Json& name : group) expect(is_variant(name), "one of the variants", name);
  }
  std::map<std::size_t, Json> wrong;  // by lane
  for (const Json& rate : report.at("rates")) {
    if (rate.at("stratum").is_null()) wrong[rate.at("lane")] = rate.at("wrong");
  }
  for (const Json& row : map.at("rows")) {
    for (const Json& cell : row.at("cells")) {
      const Json& lane = report.at("lanes").at(cell.at("lane").get<std::size_t>());
      const std::size_t variant = cell.at("variant");
      expect(variant < variants.size() && lane.at("algorithm") == row.at("algorithm") &&
                 lane.at("scalar") == row.at("scalar") && lane.at("target") == variants[variant],
             "a lane of its row and column", cell);
      const Json& rate = wrong[cell["lane"]];
      const Json& differs = cell.at("differs");
      expect(cell.at("wrong") == rate && (differs.is_null() || differs.at("of") == rate.at("of")),
             "shares of the lane's pairs", cell);
      expect(map["reference"] != variants[variant] || differs.is_null() || differs.at("count") == 0,
             "no difference between the reference and itself", cell);
    }
  }
}

}  // namespace

void expect_possible_report(const Json& report) {
  expect_shape(report, "report");
  expect_shares(report);
  expect_lanes(report, report.at("lanes").size());
  const std::uint64_t pairs = drawn_of(report, nullptr).pairs, all = report.at("run").at("pairs");
  if (pairs > all || (report["run"].at("complete").get<bool>() && pairs != all))
    throw std::runtime_error(fmt::format("expected {} pairs in its strata, found {}", all, pairs));
  for (const Json& row : report.at("strata"))
    expect(row.at("intersects") <= row.at("pairs") && row["pairs"] <= all, fmt::format("at most {} pairs", all), row);
  expect_possible_rates(report);
  expect_possible_curves(report);
  expect_possible_failures(report);
  if (const Json map = report.value("toolchains", Json()); !map.is_null()) expect_possible_map(map, report);
  if (!report.at("compare").is_null()) expect_possible_changes(report["compare"].value("verdicts", Json()), all);
}

void expect_possible_costs(const Json& costs, const Json& report) {
  expect_shape(costs, "costs");
  expect_possible_errors(costs);
  expect_lanes(costs, report.at("lanes").size());
  // An unfinished campaign may have timed pairs that are not judged yet.
  const std::uint64_t all = report.at("run").at("pairs");
  const bool complete = report["run"].at("complete");
  const auto most_of = [&](const Json& stratum) {
    return std::min(fuzz::kPairsTimed, complete ? drawn_of(report, stratum).pairs : all);
  };
  std::set<std::pair<std::string, std::string>> rows;
  for (const Json& row : costs["rows"]) {
    const Json& group = row["group"];
    expect(rows.emplace(row["lane"].dump(), group.dump()).second, "the costs of each lane in a group once", row);
    std::uint64_t most = 0;
    for (const std::size_t place : strata_in(report, group)) most += most_of(place);
    expect(row["pairs"] > 0 && row["pairs"] <= most, fmt::format("costs of 1 to {} pairs", most), row);
  }
}

void expect_possible_tuned(const Json& tuned) {
  expect_shape(tuned, "tuned");
  expect_possible_errors(tuned);
  expect_lane(tuned.at("lane"));
  for (const char* field : {"max_rate", "max_other"})
    expect(tuned.at(field) >= 0 && tuned[field] <= 1, "a rate", tuned[field]);
  expect_relocations(tuned);
  expect_choice(tuned);
  const Json& sentences = tuned.at("sentences");
  const auto breaks = std::count_if(sentences.begin(), sentences.end(), [](const Json& sentence) {
    return sentence.get<std::string>().starts_with("Scale break:");
  });
  expect(static_cast<std::size_t>(breaks) == tuned.at("scale_break").size(),
         fmt::format("{} scale breaks, as many as in its sentences", breaks), tuned["scale_break"]);
}

void expect_possible_pareto(const Json& pareto) {
  expect_shape(pareto, "pareto");
  expect_possible_errors(pareto);
  const Json& lanes = pareto.at("lanes");
  const std::uint64_t pairs = pareto.at("pairs");
  std::set<std::string> ids;
  const auto expect_row = [&](const Json& row) {
    const std::string lane = row.at("lane");
    expect_lane(row["lane"]);
    expect(ids.insert(lane).second, "each lane once", row);
    const Json& errors = row.at("errors");
    expect(errors.at("pairs") == pairs, fmt::format("errors on {} pairs", pairs), row);
    expect_upper_bound(row.at("bound"), fuzz::counts_of(errors).not_true(), pairs);
  };
  for (const Json& row : lanes) {
    expect_row(row);
    expect_costs_of_kind(row, lanes[0].contains("resident"));
  }
  for (const Json& row : pareto.value("not_timed", Json::array())) expect_row(row);
  for (const Json& row : lanes) expect_domination(row, lanes);
  std::set<std::pair<std::string, std::string>> curves;
  for (const Json& row : pareto.at("extremes")) {
    expect(ids.contains(row.at("lane")), "an extreme of a lane that was judged", row["lane"]);
    expect(
        std::any_of(std::begin(analysis::kExtremes), std::end(analysis::kExtremes),
                    [&](analysis::Extreme extreme) { return name(extreme) == row.at("extreme").get<std::string>(); }),
        "an extreme", row["extreme"]);
    expect(curves.emplace(row["lane"], row["extreme"]).second, "each extreme of a lane once", row["extreme"]);
    std::vector<analysis::ErrorsAt> points;
    for (const Json& point : row.at("points")) {
      expect((points.empty() || point.at("log2") > points.back().exponent) && point.at("pairs") <= pairs &&
                 point["pairs"] == row["points"][0]["pairs"],
             fmt::format("one point for each exponent, each with the same number of pairs, at most {}", pairs), point);
      points.push_back({point["log2"], fuzz::counts_of(point).not_true(), point["pairs"]});
    }
    expect(row.at("says") == right_words(points, 0), "the words that follow from its points", row["says"]);
  }
}

}  // namespace graze::reports
