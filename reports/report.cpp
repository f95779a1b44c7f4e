// SPDX-License-Identifier: Apache-2.0
#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/result_files.h"
#include "reports/costs.h"
#include "reports/failure_cards.h"
#include "reports/findings.h"
#include "reports/shapes.h"
#include "reports/tables.h"
#include "reports/terminal.h"
#include "reports/wilson.h"
#include "strata/strata.h"

namespace graze::reports {

using fuzz::Json;
namespace {

// The machines that the campaign ran on, as far as their names are known.
Json machines(const std::filesystem::path& directory) {
  const Json timings = Json::parse(fuzz::read_whole(directory / "timings.json"), nullptr, false);
  if (!timings.is_object() || !timings.value("runs", Json()).is_array()) return nullptr;
  std::set<std::string> names;
  for (const Json& run : timings["runs"]) {
    const Json machine = run.is_object() ? run.value("machine", Json()) : Json();
    if (machine.is_string() && run.value("pairs", Json()) > Json(0)) names.insert(machine.get<std::string>());
  }
  return names.empty() ? Json() : Json(fmt::format("{}", fmt::join(names, "; ")));
}

Json run_of(const std::filesystem::path& directory, const Json& summary, const CampaignCounts& counts) {
  Json build = Json::object();
  for (const char* key : {"version", "commit", "compiler", "cuda", "device"})
    build[key] = summary.at("build").value(key, Json());
  return {{"seed", counts.seed},
          {"pairs", counts.pairs},
          {"complete", counts.complete},
          {"command", campaign_command(summary)},
          {"map_command", "graze report campaign"},
          {"build", build},
          {"scene", summary.at("spec").contains("scene") ? summary["spec"]["scene"].at("name") : Json()},
          {"machine", machines(directory)}};
}

Json strata_of(const CampaignCounts& counts) {
  Json rows = Json::array();
  for (const StratumCounts& stratum : counts.strata) {
    const auto info = std::find_if(std::begin(strata::kStrata), std::end(strata::kStrata),
                                   [&](const strata::StratumInfo& s) { return s.id == stratum.id; });
    rows.push_back(
        {{"id", stratum.id},
         {"describes",
          info != std::end(strata::kStrata) ? info->what : "pairs of a mesh's triangles whose boxes overlap"},
         {"pairs", stratum.pairs},
         {"intersects", stratum.intersects}});
  }
  return rows;
}

Json lanes_of(const Json& summary, const CampaignCounts& counts) {
  Json rows = Json::array();
  const Json executors = summary.at("build").value("executors", Json::object());
  for (const ReportLane& lane : counts.lanes) {
    rows.push_back({{"id", lane.id},
                    {"algorithm", lane.name.subject},
                    {"scalar", lane.name.scalar},
                    {"target", lane.name.variant},
                    {"paper", lane.row ? lane.row->info->paper : ""},
                    {"evidence", executors.value(lane.id, Json())},
                    {"exact", lane.exact}});
  }
  return rows;
}

Json missing_of(const CampaignCounts& counts, const Json& summary, const std::filesystem::path& directory) {
  Json missing = Json::array();
  if (!fuzz::has_database(directory))
    missing.push_back(
        "The counts are those of summary.json, checked only against each other: the campaign's database is not beside "
        "it.");
  if (const Json& spec = summary.at("spec"); spec.contains("lanes_left_out")) {
    for (const std::string& line : fuzz::left_out_in_words(fuzz::left_out_of(spec["lanes_left_out"])))
      missing.push_back(fmt::format("Lanes that were asked for did not run: {}.", line));
  }
  if (!counts.complete) {
    missing.push_back(
        fmt::format("The campaign is not finished, {} of {} pairs are in it: the command that began it goes "
                    "on with it.",
                    grouped(counts.total.pairs), grouped(counts.pairs)));
  }
  if (counts.total.extremes.empty()) {
    missing.push_back(
        "No error rates over scale and offset: the strata that vary them, such as extreme_scale and "
        "far_from_origin, were not drawn, or the campaign was made before they were counted.");
  }
  return missing;
}

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
    std::uint64_t wrong = 0;
    for (const char* field : {"declined", "crashed", "timed_out", "unstable"})
      wrong += row.value(field, std::uint64_t{0});
    for (const char* field : {"false_positive", "false_negative"})
      wrong += row.at(field).at("count").get<std::uint64_t>();
    const Json& differs = row.at("differs_from_cpu");
    expect(row.at("wrong").at("count") == wrong && row["wrong"].at("of") == of.pairs &&
               row["false_negative"].at("of") == of.intersects &&
               row["false_positive"].at("of") == of.pairs - of.intersects &&
               (differs.is_null() || differs.at("of") == of.pairs) &&
               row.value("by_convention", std::uint64_t{0}) <= of.pairs - wrong,
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

// Counts are within each other, and add up.   Throws: std::runtime_error; Json::exception for a place that is not
// there.
void expect_possible(const Json& report) {
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

}  // namespace

Json make_report(const std::filesystem::path& directory) {
  const Json summary = fuzz::checked_summary(directory);
  try {
    const CampaignCounts counts = counts_of(summary);
    Json report = {{"format", 2},
                   {"run", run_of(directory, summary, counts)},
                   {"strata", strata_of(counts)},
                   {"lanes", lanes_of(summary, counts)},
                   {"answer", answer(counts, nullptr)},
                   {"groups", groups(counts)},
                   {"rates", rates(counts)},
                   {"group_rates", group_rates(counts)},
                   {"side_by_side", side_by_side(counts)},
                   {"margins", margins(counts)},
                   {"thresholds", thresholds(counts)},
                   {"extremes", extremes(counts)},
                   {"signature_count", 0},
                   {"signatures", nullptr},
                   {"sources", nullptr},
                   {"cards", nullptr},
                   {"missing", missing_of(counts, summary, directory)},
                   {"compare", nullptr}};
    add_signatures(report, directory, summary, counts);
    return report;
  } catch (const Json::exception&) {
    throw corpus::FormatError((directory / "summary.json").string() +
                              ": expected a campaign's summary, found something else");
  } catch (const std::logic_error&) {  // a text that is no number, or no signature
    throw corpus::FormatError((directory / "summary.json").string() +
                              ": expected a campaign's summary, found something else");
  }
}

Json make_costs(const std::filesystem::path& directory) {
  const CampaignCounts counts = counts_of(fuzz::checked_summary(directory));
  try {
    const std::optional<Costs> costs = read_costs(directory, counts);
    return costs ? to_json(*costs, counts) : Json();
  } catch (const Json::exception&) {
    throw corpus::FormatError((directory / "timings.json").string() +
                              ": expected a campaign's timings, found something else");
  }
}

namespace {

// Of `graze tune` and `graze trade`: no lane errs on more pairs than there were, and quartiles are in order.
void expect_possible_errors(const Json& part) {
  if (part.is_object() && part.contains("misses") && part.contains("pairs")) {
    std::uint64_t errors = 0;
    const std::uint64_t pairs = part["pairs"];
    bool possible = true;
    for (const char* field : {"misses", "false_hits", "declined", "mended", "broken"})
      possible = possible && part.value(field, std::uint64_t{0}) <= pairs;
    for (const char* field : {"misses", "false_hits", "declined"}) errors += part.at(field).get<std::uint64_t>();
    expect(possible && errors <= pairs, fmt::format("errors on at most {} pairs", pairs), part);
  } else if (part.is_object() && part.contains("middle")) {
    expect(0 <= part.at("low") && part["low"] <= part["middle"] && part["middle"] <= part.at("high"),
           "quartiles in their order", part);
  } else if (part.is_structured()) {
    for (const Json& inner : part) expect_possible_errors(inner);
  }
}

std::uint64_t sum_of(const Json& errors, std::initializer_list<const char*> fields) {
  std::uint64_t sum = 0;
  for (const char* field : fields) sum += errors.at(field).get<std::uint64_t>();
  return sum;
}

void expect_possible_tuned(const Json& tuned) {
  const Json &confirmed = tuned.at("confirmed"), &forbid = tuned.at("forbid");
  const std::uint64_t forbidden = forbid == "miss"    ? sum_of(confirmed, {"misses"})
                                  : forbid == "false" ? sum_of(confirmed, {"false_hits"})
                                                      : sum_of(confirmed, {"misses", "false_hits"});
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
  for (const Json& row : trade.at("lanes")) {
    const Json& errors = row.at("errors");
    expect(errors.at("pairs") == trade["lanes"][0].at("errors").at("pairs"), "the pairs of the first lane", row);
    expect_bound(row.at("bound"), sum_of(errors, {"misses", "false_hits", "declined"}), errors.at("pairs"), row);
  }
}

// Checks a file that graze wrote.   Throws: FormatError that names it.
template <class Check>
void checked(const std::filesystem::path& file, const char* what, Check check) {
  try {
    check();
  } catch (const Json::exception&) {
    throw corpus::FormatError(fmt::format("{}: expected {}, found something else", file.string(), what));
  } catch (const std::runtime_error& error) {
    throw corpus::FormatError(file.string() + ": " + error.what());
  }
}

}  // namespace

Json make_choices(const std::filesystem::path& directory) {
  const auto read = [&](const char* name, const char* shape, void (*expect_possible_counts)(const Json&)) -> Json {
    const std::filesystem::path file = directory / name;
    if (!std::filesystem::exists(file)) return nullptr;
    Json found = Json::parse(fuzz::read_whole(file), nullptr, false);
    checked(file, "what graze writes into it", [&] {
      expect_shape(found, shape);
      expect_possible_errors(found);
      expect_possible_counts(found);
    });
    return found;
  };
  return {{"tuned", read("tune.json", "tuned", expect_possible_tuned)},
          {"trade", read("trade.json", "trade", expect_possible_trade)}};
}

std::string report_text(const Json& report) {
  std::string text = "{";
  for (const auto& [key, value] : report.items()) {
    text += fmt::format("{}\n\"{}\": ", text.size() > 1 ? "," : "", key);
    if (!value.is_array() || value.empty()) {
      text += value.dump();
      continue;
    }
    for (std::size_t i = 0; i < value.size(); ++i) text += (i == 0 ? "[\n" : ",\n") + value[i].dump();
    text += "\n]";
  }
  return text + "\n}\n";
}

Json read_report(const std::filesystem::path& file) {
  Json report = Json::parse(fuzz::read_whole(file), nullptr, false);
  if (!report.is_object() || report.value("format", Json()) != 2)
    throw corpus::FormatError(file.string() + ": expected a report of `graze report`, found something else");
  checked(file, "a report of `graze report`", [&] { expect_possible(report); });
  return report;
}

Json stored_costs(const std::filesystem::path& file, const Json& report) {
  if (!std::filesystem::exists(file)) return nullptr;
  Json costs = Json::parse(fuzz::read_whole(file), nullptr, false);
  checked(file, "costs of `graze report`", [&] {
    expect_shape(costs, "costs");
    expect_possible_errors(costs);
    expect_lanes(costs, report.at("lanes").size());
    for (const Json& row : costs["rows"]) drawn_of(report, nullptr, row["group"]);
  });
  return costs;
}

}  // namespace graze::reports
