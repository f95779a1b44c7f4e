// SPDX-License-Identifier: Apache-2.0
#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "core/cannot.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/sealed.h"
#include "reports/costs.h"
#include "reports/discrepancy.h"
#include "reports/failure_cards.h"
#include "reports/findings.h"
#include "reports/possible_counts.h"
#include "reports/recorded_code.h"
#include "reports/tables.h"
#include "reports/terminal.h"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::reports {

using fuzz::Json;
namespace {

// The machines that the campaign ran on, if their names are known. Only runs that recorded pairs count. If no run did,
// because each was killed before it recorded the pairs it had decided, all recorded runs count.
Json machines(const std::filesystem::path& directory) {
  std::set<std::string> names, without_pairs;
  for (const Json& run : fuzz::read_timings(directory)) {
    const Json machine = run.value("machine", Json());
    if (machine.is_string())
      (run.value("pairs", Json()) > Json(0) ? names : without_pairs).insert(machine.get<std::string>());
  }
  if (names.empty()) names = without_pairs;
  return names.empty() ? Json() : Json(fmt::format("{}", fmt::join(names, "; ")));
}

Json run_of(const std::filesystem::path& directory, const Json& summary, const CampaignCounts& counts) {
  Json build = Json::object();
  for (const char* key : {"version", "commit", "compiler", "cuda", "device"})
    build[key] = summary.at("build").value(key, Json());
  Json run = {{"seed", counts.seed},
              {"pairs", counts.pairs},
              {"complete", counts.complete},
              {"command", fuzz::command_of(summary.at("spec"), {}, "campaign", summary)},
              {"map_command", "graze report campaign"},
              {"build", build},
              {"scene", summary.at("spec").contains("scene") ? summary["spec"]["scene"].at("name") : Json()},
              {"machine", machines(directory)}};
  if (const Json code = code_json(summary["spec"].value("subjects", Json())); !code.is_null()) run["subjects"] = code;
  return run;
}

// Describes a stratum's pairs. Different meshes have different descriptions, as do hunts from different strata.
std::string description_of(const std::string& stratum, const Json& spec) {
  if (const strata::StratumInfo* row = strata::stratum_info(stratum))
    return described(row->what, strata::stratum_in_doubles(stratum).has_value(), spec);
  if (spec.contains("hunt")) {
    const std::vector<std::string> from = spec["hunt"].at("strata");
    const bool in_doubles = strata::stratum_in_doubles(stratum).has_value();
    const std::size_t all = in_doubles ? std::size(strata::kDoubleStrata) : std::size(strata::kStrata);
    return "pairs that guided search made from " + (from.size() == all
                                                        ? std::string("all strata") + (in_doubles ? " of doubles" : "")
                                                        : fmt::format("{}", fmt::join(from, ", ")));
  }
  const std::string mesh =
      spec.contains("mesh") ? " (content " + spec["mesh"].at("content").get<std::string>() + ")" : "";
  return "pairs of a mesh's triangles whose boxes overlap" + mesh;
}

Json strata_of(const CampaignCounts& counts, const Json& spec) {
  Json rows = Json::array();
  for (const StratumCounts& stratum : counts.strata) {
    rows.push_back({{"id", stratum.id},
                    {"describes", description_of(stratum.id, spec)},
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
        "The counts come from summary.json and are checked only against each other, because the campaign's database is "
        "missing.");
  if (const Json& spec = summary.at("spec"); spec.contains("lanes_left_out")) {
    for (const std::string& line : fuzz::left_out_in_words(fuzz::left_out_of(spec["lanes_left_out"])))
      missing.push_back(fmt::format("Lanes that were asked for did not run: {}.", line));
  }
  if (!counts.complete) {
    missing.push_back(
        fmt::format("The campaign is not finished: {} of {} pairs are done. To resume it, run its command again.",
                    grouped(counts.total.pairs), grouped(counts.pairs)));
  }
  if (counts.total.extremes.empty()) {
    missing.push_back(
        "There are no error rates over scale and offset: the strata that vary them, such as extreme_scale and "
        "far_from_origin, were not drawn, or the campaign is older than these counts.");
  }
  return missing;
}

}  // namespace

Json make_report(const std::filesystem::path& directory) {
  const Json summary = fuzz::checked_summary(directory);
  try {
    const CampaignCounts counts = counts_of(summary);
    Json report = {
        {"format", 2},
        {"run", run_of(directory, summary, counts)},
        {"strata", strata_of(counts, summary.at("spec"))},
        {"lanes", lanes_of(summary, counts)},
        {"answer", answer(counts, nullptr, fuzz::read_kinds(directory))},
        {"groups", groups(counts)},
        {"rates", rates(counts)},
        {"group_rates", group_rates(counts)},
        {"side_by_side", side_by_side(counts)},
        {"toolchains", has_toolchains(counts) ? toolchain_map(counts, signature_rows(counts, summary)) : Json()},
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
    throw corpus::FormatError(cannot("use", directory / "summary.json", "it is not the summary of a campaign"));
  } catch (const std::logic_error&) {  // invalid numbers or signatures
    throw corpus::FormatError(cannot("use", directory / "summary.json", "it is not the summary of a campaign"));
  }
}

namespace {

constexpr const char* kAgain = "make it again: graze report DIR";

// Checks a file that Graze wrote.   Throws: FormatError with the file's name.
template <class Check>
void checked(const std::filesystem::path& file, const char* what, Check check) {
  try {
    check();
  } catch (const Json::exception&) {
    throw corpus::FormatError(cannot("use", file, fmt::format("it does not hold {}", what)));
  } catch (const std::runtime_error& error) {
    throw corpus::FormatError(cannot("use", file, error.what()));
  }
}

}  // namespace

Json make_costs(const std::filesystem::path& directory) {
  const CampaignCounts counts = counts_of(fuzz::checked_summary(directory));
  Json made;
  checked(directory / "timings.json", "a campaign's timings", [&] {
    if (const std::optional<Costs> costs = costs_of(fuzz::read_timings(directory), counts))
      made = to_json(*costs, counts, fuzz::read_kinds(directory));
  });
  return made;
}

namespace {

// Reads a file and checks its contents. Returns null if there is no such file.
Json read_checked(const std::filesystem::path& file, void (*expect_possible)(const Json&)) {
  Json found = fuzz::read_sealed(file, "remove it, or make it again");
  if (!found.is_null()) checked(file, "what graze writes into it", [&] { expect_possible(found); });
  return found;
}

// A sentence if `graze discrepancy` wrote counts on other pairs into the campaign's folder; otherwise empty.
std::string other_pairs(const std::filesystem::path& directory, const Json& spec, const Json& discrepancy) {
  if (!spec.is_object()) return "";
  const std::vector<std::string> drawn = spec.at("strata");
  const std::string scene = spec.contains("scene") ? spec["scene"].at("name") : "";
  bool other = spec.at("seed") != discrepancy.at("seed") || discrepancy.value("scene", "") != scene;
  const Json counted_there = fuzz::parse_shallow(fuzz::read_whole(directory / "summary.json"));
  for (const char* kind : {"lanes", "verdicts"}) {
    for (const Json& of : discrepancy.value(kind, Json::array())) {
      for (const auto& [stratum, found] : of.at("strata").items()) {
        other |= std::find(drawn.begin(), drawn.end(), stratum) == drawn.end();
        const Json::json_pointer place = Json::json_pointer() / "strata" / stratum / "pairs";
        other |= counted_there.contains(place) && found.value("pairs", std::uint64_t{0}) > counted_there.at(place);
      }
    }
  }
  if (!other) return "";
  return fmt::format("The sentences on CPU and GPU are about {} that the campaign did not draw (seed {}).",
                     counted(discrepancy.at("pairs").get<std::uint64_t>(), "pair"), discrepancy["seed"].dump());
}

}  // namespace

Json read_discrepancy(const std::filesystem::path& file) { return read_checked(file, expect_possible_discrepancy); }

Json make_choices(const std::filesystem::path& directory) {
  const auto read = [&](const char* name, void (*expect_possible)(const Json&)) {
    return read_checked(directory / name, expect_possible);
  };
  const Json values = read_discrepancy(directory / "discrepancy.json");
  const Json tuned = read("tune.json", expect_possible_tuned), pareto = read("pareto.json", expect_possible_pareto);
  const bool none = values.is_null() && tuned.is_null() && pareto.is_null();
  const Json spec = none ? Json() : fuzz::recorded_spec(directory);
  // Says first that a result is about other code than the campaign's.
  const auto told = [&](Json result, const Json& of) {
    if (result.is_null() || !spec.is_object()) return result;
    std::vector<std::string> differences = code_differences(spec, of);
    if (differences.empty()) return result;
    differences.insert(differences.begin(), "These results are not about the code that the campaign ran.");
    for (const Json& sentence : result.at("sentences")) differences.push_back(sentence);
    result["sentences"] = differences;
    return result;
  };
  Json discrepancy;
  if (!values.is_null()) {
    std::vector<std::string> sentences = discrepancy_answer(values);
    if (std::string others = other_pairs(directory, spec, values); !others.empty())
      sentences.insert(sentences.begin(), std::move(others));
    discrepancy = {{"sentences", sentences}, {"page", "discrepancy.html"}};
  }
  return {{"tuned", told(tuned, tuned)}, {"pareto", told(pareto, pareto)}, {"discrepancy", told(discrepancy, values)}};
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
  Json report = fuzz::read_sealed(file, kAgain, fuzz::NamedBy::user);
  if (!report.is_object() || report.value("format", Json()) != 2)
    throw corpus::FormatError(cannot("use", file, "it is not a report of `graze report`"));
  checked(file, "a report of `graze report`", [&] { expect_possible_report(report); });
  return report;
}

Json stored_costs(const std::filesystem::path& file, const Json& report) {
  Json costs = fuzz::read_sealed(file, kAgain);
  if (costs.is_null()) return costs;
  checked(file, "costs of `graze report`", [&] { expect_possible_costs(costs, report); });
  if (costs.value("report", "") != fuzz::sealed(report).at("checksum").get<std::string>())
    throw std::runtime_error(cannot("use", file, fmt::format("it belongs to another report.json; {}", kAgain)));
  return costs;
}

}  // namespace graze::reports
