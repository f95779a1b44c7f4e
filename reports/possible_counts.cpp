// SPDX-License-Identifier: Apache-2.0
#include "reports/possible_counts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/pair.h"
#include "core/text.h"
#include "fuzz/counts_json.h"
#include "reports/failure_cards.h"
#include "reports/shapes.h"
#include "reports/tables.h"
#include "reports/wilson.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// Throws: std::runtime_error that says what was expected of the part.
void expect(bool possible, const std::string& what, const Json& part) {
  if (!possible) throw std::runtime_error(fmt::format("expected {}, found {}", what, shown(part.dump())));
}

// Every share in it is what its counts give.
void expect_shares(const Json& part) {
  if (part.is_object() && part.contains("count") && part.contains("of") && part.contains("share")) {
    const std::uint64_t count = part["count"], of = part["of"];
    expect(count <= of && part == to_json(share_of(count, of)), fmt::format("a share of at most {} pairs", of), part);
  } else if (part.is_structured()) {
    for (const Json& inner : part) expect_shares(inner);
  }
}

// The bound of a rate is above what was seen of it.
void expect_bound(const Json& bound, std::uint64_t count, std::uint64_t of, const Json& part) {
  const double least = of == 0 ? 1 : std::max(static_cast<double>(count) / static_cast<double>(of), bound_of_none(of));
  expect(bound >= (1 - 1e-9) * least && bound <= 1, fmt::format("a bound of {} of {} pairs", count, of), part);
}

struct Drawn {
  std::uint64_t pairs = 0, intersects = 0;
};

// The pairs of a stratum or a group, by place, or of all.
Drawn drawn_of(const Json& report, const Json& stratum, const Json& group = {}) {
  if (!stratum.is_null()) {
    const Json& row = report.at("strata").at(stratum.get<std::size_t>());
    return {row.at("pairs"), row.at("intersects")};
  }
  Drawn sum;
  const auto add = [&](const Json& place) {
    const Drawn one = drawn_of(report, place);
    sum.pairs += one.pairs;
    sum.intersects += one.intersects;
  };
  if (!group.is_null()) {
    for (const Json& place : report.at("groups").at(group.get<std::size_t>()).at("strata")) add(place);
  } else {
    for (std::size_t s = 0; s < report.at("strata").size(); ++s) add(s);
  }
  return sum;
}

void expect_possible_rates(const Json& report) {
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
               counts.not_right() + counts.by_convention <= of.pairs,
           fmt::format("rates of {} pairs that add up", of.pairs), row);
  }
  for (const Json& row : report.at("group_rates"))
    expect(row.at("wrong").at("of") == drawn_of(report, nullptr, row.at("group")).pairs, "the pairs of its group", row);
  for (const Json& rows : report.at("side_by_side")) {
    for (const Json& row : rows.at("strata")) {
      for (const char* field : {"left_wrong", "right_wrong", "differs"}) {
        expect(row.at(field).is_null() || row[field].at("of") == drawn_of(report, row.at("stratum")).pairs,
               "the pairs of its stratum", row);
      }
    }
  }
}

// What is counted by margin, scale and offset.
void expect_possible_curves(const Json& report) {
  const auto pairs_of = [](const Json& cells) {
    std::uint64_t pairs = 0;
    for (const Json& cell : cells) pairs += cell.at("wrong").at("of").get<std::uint64_t>();
    return pairs;
  };
  for (const Json& row : report.at("margins")) {
    const std::uint64_t pairs = drawn_of(report, row.at("stratum")).pairs;
    expect(pairs_of(row.at("points")) == pairs, fmt::format("points of {} pairs", pairs), row);
  }
  for (const Json& row : report.at("extremes")) {
    const std::uint64_t pairs = drawn_of(report, nullptr).pairs;
    expect(pairs_of(row.at("cells")) <= pairs, fmt::format("cells of at most {} pairs", pairs), row);
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
    expect(count > 0 && count <= pairs && row.at("share") == rounded_share(count, pairs),
           fmt::format("a share of {} pairs", pairs), row);
    for (const Json& card : row.at("cards")) report.at("cards").at(card.get<std::size_t>());
  }
  for (const Json& card : report.at("cards")) {
    const Json& kind = card.at("kind");
    const std::uint64_t of_kind = kind.at("pairs");
    std::uint64_t by_margin = 0;
    bool possible = of_kind <= pairs && kind.at("signatures") <= signatures && kind.at("settled").size() == 2 &&
                    kind["settled"][0] <= kind["settled"][1] &&
                    kind["settled"][1] <= kind["signatures"].get<std::uint64_t>() * kind.at("lanes").size();
    for (const Json& count : kind.at("margins")) by_margin += count.get<std::uint64_t>();
    for (const char* by : {"margins", "strata"}) {
      for (const Json& count : kind.at(by)) possible = possible && count <= of_kind;
    }
    for (const char* form : {"decimal", "hex", "value"})
      possible = possible && card.at("pair").at(form).size() == kCoordinates;
    for (const char* part : {"contact", "planes_line"}) {
      for (const Json& point : card.at("drawing").at(part)) possible = possible && point.size() == 3;
    }
    expect(possible && by_margin == of_kind, fmt::format("a kind of failure of at most {} pairs", pairs), kind);
  }
}

// All lanes that it names by place are there.
void expect_lanes(const Json& part, std::size_t lanes) {
  for (const auto& [name, inner] : part.items()) {
    if (part.is_object() && (name == "lane" || name == "left" || name == "right") && inner.is_number())
      expect(inner < lanes, fmt::format("a place among {} lanes", lanes), part);
    if (inner.is_structured()) expect_lanes(inner, lanes);
  }
}

// Of `graze tune` and `graze trade`: no lane errs on more pairs than there were, and quartiles are in order.
void expect_possible_errors(const Json& part) {
  if (part.is_object() && part.contains("declined") && part.contains("pairs")) {
    const std::uint64_t pairs = part["pairs"];
    bool possible = true;
    for (const char* field : {"false_positive", "false_negative", "declined", "fixed", "broken"})
      possible = possible && part.value(field, std::uint64_t{0}) <= pairs;
    expect(possible && fuzz::counts_of(part).not_right() <= pairs, fmt::format("errors on at most {} pairs", pairs),
           part);
  } else if (part.is_object() && part.contains("middle")) {
    expect(0 <= part.at("low") && part["low"] <= part["middle"] && part["middle"] <= part.at("high"),
           "quartiles in their order", part);
  } else if (part.is_structured()) {
    for (const Json& inner : part) expect_possible_errors(inner);
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
}

void expect_possible_costs(const Json& costs, const Json& report) {
  expect_shape(costs, "costs");
  expect_possible_errors(costs);
  expect_lanes(costs, report.at("lanes").size());
  for (const Json& row : costs["rows"]) drawn_of(report, nullptr, row["group"]);
}

void expect_possible_tuned(const Json& tuned) {
  expect_shape(tuned, "tuned");
  expect_possible_errors(tuned);
  const Json &confirmed = tuned.at("confirmed"), &forbid = tuned.at("forbid");
  const Counts counts = fuzz::counts_of(confirmed);
  const std::uint64_t forbidden = forbid == "false_negative"   ? counts.false_negative
                                  : forbid == "false_positive" ? counts.false_positive
                                                               : counts.wrong();
  expect_bound(tuned.at("bound"), forbidden, confirmed.at("pairs"), tuned["bound"]);
  expect(tuned.at("zero_confirmed").at("pairs") == confirmed["pairs"], "the pairs of `confirmed`",
         tuned["zero_confirmed"]);
  for (const Json& curve : tuned.at("curves")) {
    for (const Json& point : curve.at("points"))
      expect(point.at("pairs") == tuned.at("zero").at("pairs"), "the pairs of `zero`", point);
  }
  expect(tuned.at("max_rate") >= 0 && tuned["max_rate"] <= 1, "a rate", tuned["max_rate"]);
  const Json& sentences = tuned.at("sentences");
  const auto breaks = std::count_if(sentences.begin(), sentences.end(), [](const Json& sentence) {
    return sentence.get<std::string>().starts_with("Scale break:");
  });
  expect(static_cast<std::size_t>(breaks) == tuned.at("scale_break").size(),
         fmt::format("{} scale breaks, as its sentences say", breaks), tuned["scale_break"]);
}

void expect_possible_trade(const Json& trade) {
  expect_shape(trade, "trade");
  expect_possible_errors(trade);
  for (const Json& row : trade.at("lanes")) {
    const Json& errors = row.at("errors");
    expect(errors.at("pairs") == trade["lanes"][0].at("errors").at("pairs"), "the pairs of the first lane", row);
    expect_bound(row.at("bound"), fuzz::counts_of(errors).not_right(), errors.at("pairs"), row);
  }
}

}  // namespace graze::reports
