// SPDX-License-Identifier: Apache-2.0
#include "cli/try_answer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/verdicts_apart.h"
#include "cli/fuzz.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/files.h"
#include "reports/cost_words.h"
#include "reports/own_code.h"
#include "reports/tables.h"
#include "reports/terminal.h"
#include "subjects/rebuilt.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

// Too many pairs for a processor to learn their branches, but few enough for a core's cache.
constexpr std::size_t kPairsCalled = 4096;
constexpr int kPassesOfCalls = 101;
constexpr int kLinesOfScreen = 30, kLinesOfCosts = 4;
constexpr std::size_t kMostNamed = 3;        // numbers that may be the epsilon
constexpr std::size_t kMostTried = 6;        // of them, each replaced alone
constexpr double kLargestEpsilon = 0.1;      // a larger constant is not an epsilon
constexpr std::size_t kMostStrataNamed = 6;  // strata that were left out

std::string why_not_called(const Lane& lane) {
  if (const std::string why = analysis::why_not_timed(lane); !why.empty()) return why;
  const subjects::Opened* subject = subjects::opened(lane.lane_name().subject);
  return subject && subject->description.of_blocks ? "it takes blocks of pairs" : "it failed on some pairs";
}

// "kEps = 1e-6f at mine.cpp:3"
std::string epsilon_in_words(const std::filesystem::path& source, const subjects::Epsilon& epsilon) {
  return printable(fmt::format("{}{} at {}", epsilon.name == epsilon.written ? "" : epsilon.name + " = ",
                               epsilon.written, subjects::places_in_words(source, epsilon)));
}

// Applies the checks of `graze tune`, so that `graze tune` accepts the suggested command.
std::optional<subjects::TunableSource> tunable(const Lane& own, const std::string& name) {
  try {
    return subjects::tunable_source(own, name);
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

Json cost_json(const CallCosts::Row& row) {
  if (!row.cost) return {{"lane", row.lane->id}, {"why_not", row.why_not}};
  return {{"lane", row.lane->id}, {"low", row.cost->low}, {"middle", row.cost->middle}, {"high", row.cost->high}};
}

std::string costs_in_words(const CallCosts& costs) {
  std::vector<std::string> lanes;
  std::vector<analysis::Cost> found;
  std::string not_measured;
  for (const CallCosts::Row* row : {&costs.own, &costs.exact, &costs.cheapest}) {
    if (row->cost) {
      lanes.push_back(row->lane->id);
      found.push_back(*row->cost);
    } else {
      not_measured += fmt::format(" Cost of {}: not measured, because {}.", row->lane->id, row->why_not);
    }
  }
  return reports::one_call_sentence(lanes, found, reports::counted(costs.pairs, "pair"), fuzz::machine_name(),
                                    kPassesOfCalls) +
         not_measured;
}

// own: the user's lane.
std::string exact_in_words(const Lane& exact, const reports::ReportLane& own, const reports::CampaignCounts& counts) {
  const bool of_float32 = exact.scalar == Scalar::f32;
  const std::uint64_t not_right = counts.total.lanes[counts.find(exact.lane_name()).value()].not_right();
  return fmt::format("Instead: {} is {}{}.", exact.id,
                     not_right == 0
                         ? fmt::format("right on all {} pairs", reports::grouped(counts.total.pairs))
                         : fmt::format("not right on {}, which must never happen", reports::counted(not_right, "pair")),
                     of_float32 && own.name.scalar == name(Scalar::f64)
                         ? fmt::format("; these are float32 pairs; on pairs of doubles {} is right, and --coordinates "
                                       "f64 draws them",
                                       fuzz::kExactDoubles)
                         : "");
}

// The effect of a negligible number in place of all of these; nothing if the code cannot be rebuilt so.
std::optional<reports::EpsilonEffect> effect_of(const Lane& own, const std::vector<subjects::Epsilon>& numbers,
                                                const std::vector<strata::PairSource>& sources) {
  const auto changed = numbers.empty() ? nullptr : subjects::changed(own, {.negligible = numbers});
  if (!changed) return std::nullopt;
  reports::EpsilonEffect effect;
  effect.by = subjects::negligible_in_words(numbers);
  const std::filesystem::path& file = subjects::opened(own.lane_name().subject)->file;
  for (const subjects::Epsilon& number : numbers)
    effect.named += (effect.named.empty() ? "" : " and ") + epsilon_in_words(file, number);
  const auto found = analysis::verdicts_apart({{&own, &own}, {own.decide, *changed}}, sources, 0,
                                              [](const AnyPair&, const AnyPair&) { return false; });
  for (const analysis::VerdictsApart& of_source : found) {
    effect.mended += of_source.mended;
    effect.broken += of_source.broken;
  }
  return effect;
}

std::string left_out_in_words(const std::vector<strata::LeftOut>& left_out) {
  std::vector<std::string> ids;
  for (const strata::LeftOut& row : left_out) ids.push_back(row.id);
  const std::size_t all = ids.size();
  if (all > kMostStrataNamed) {
    ids.resize(kMostStrataNamed);
    ids.push_back(fmt::format("{} more", all - kMostStrataNamed));
  }
  return fmt::format("Left out, because the scene cannot contain them: {}.", fmt::join(ids, ", "));
}

}  // namespace

CallCosts call_costs(const Lane& own, const std::vector<strata::PairSource>& sources) {
  const bool in_doubles = analysis::any_in_doubles(sources);
  std::vector<const Lane*> timed = {&own, find_lane(in_doubles ? fuzz::kExactDoubles : fuzz::kExactLane)};
  for (const Lane& lane : published_lanes()) {
    if (lane.variant == Variant::cpu && lane.scalar == (in_doubles ? Scalar::f64 : Scalar::f32)) timed.push_back(&lane);
  }
  const strata::PairBlock pairs = analysis::first_pairs(sources, kPairsCalled);
  const std::vector<std::optional<analysis::Cost>> costs =
      analysis::costs_of(timed, pairs, kPassesOfCalls, analysis::Calls::of_one);
  const auto least = std::min_element(costs.begin() + 2, costs.end(),
                                      [](const auto& l, const auto& r) { return l.value().middle < r.value().middle; });
  return {{timed[0], costs[0], costs[0] ? "" : why_not_called(own)},
          {timed[1], costs[1]},
          {timed[static_cast<std::size_t>(least - costs.begin())], *least},
          pairs.size()};
}

OwnEpsilon epsilon_of_code(const Lane& own, const std::vector<strata::PairSource>& sources, bool is_wrong,
                           const std::string& directory) {
  if (const std::string why = subjects::why_not_rebuilt(own); !why.empty())
    return {"", "", fmt::format("Graze cannot change its epsilon: {}.", why)};
  const std::string tune = fmt::format("graze tune {} --from {}", own.id, path_word(directory));
  if (const auto source = tunable(own, "")) return {epsilon_in_words(source->file, source->epsilon), tune, ""};
  const std::filesystem::path& file = subjects::opened(own.lane_name().subject)->file;
  const std::string text = fuzz::read_whole(file);
  std::vector<subjects::Epsilon> candidates = subjects::epsilons_in(text);
  std::erase_if(candidates, [&](const subjects::Epsilon& e) {
    return (e.value && (*e.value <= 0 || *e.value > kLargestEpsilon)) || !tunable(own, e.name);
  });
  if (is_wrong && candidates.size() > 1) {  // the one whose replacement mends most comes first
    std::vector<std::uint64_t> mended(std::min(candidates.size(), kMostTried));
    for (std::size_t i = 0; i < mended.size(); ++i) {
      if (const auto effect = effect_of(own, {candidates[i]}, sources)) mended[i] = effect->mended;
    }
    const auto first = candidates.begin() + (std::max_element(mended.begin(), mended.end()) - mended.begin());
    std::rotate(candidates.begin(), first, first + 1);
  }
  OwnEpsilon found;
  if (!candidates.empty()) found.tune = fmt::format("{} --epsilon {}", tune, shell_word(candidates[0].name));
  if (candidates.empty()) candidates = subjects::small_numbers_in(text);
  std::vector<std::string> words;
  for (const subjects::Epsilon& e : candidates) {
    if (words.size() < kMostNamed) words.push_back(epsilon_in_words(file, e));
  }
  found.named = fmt::format("{}", fmt::join(words, " or "));
  if (found.tune.empty())
    found.why_not = fmt::format("Graze cannot change {}: {}.", words.empty() ? "its epsilon" : "it",
                                words.empty() ? "it finds none in " + printable(file.filename().string())
                                              : "`graze tune --epsilon` cannot name it");
  return found;
}

std::optional<reports::EpsilonEffect> epsilon_effect(const Lane& own, const std::vector<strata::PairSource>& sources) {
  std::vector<subjects::Epsilon> numbers = subjects::small_numbers(own);
  if (const auto obvious = numbers.empty() ? std::nullopt : tunable(own, "")) numbers = {obvious->epsilon};
  return effect_of(own, numbers, sources);
}

std::string case_of(const Answer& answer, const Json& kind) {
  return answer.directory + '/' + kind.at("simplest").at("case").get<std::string>();
}

Json to_json(const Answer& answer, const fuzz::SelectedLanes& under_test) {
  const reports::CampaignCounts counts = reports::counts_of(answer.summary);
  const std::size_t lane = reports::own_lanes(counts).front();
  Json groups = Json::object(), failures = Json::array(), builds = Json::object(), left_out = Json::array();
  for (const reports::GroupCounts& group : counts.groups)
    groups[group.id] = reports::to_json(share_of(group.counts.wrong(lane), group.counts.pairs));
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    if (counts.lanes[l].name.subject == answer.code.name)
      builds[counts.lanes[l].id] = reports::to_json(share_of(counts.total.wrong(l), counts.total.pairs));
  }
  for (const Json& kind : answer.told) {
    const Json& simplest = kind.at("simplest");
    failures.push_back({{"pairs", kind.at("pairs")},
                        {"intersecting", kind.at("intersecting")},
                        {"shape", kind.at("shape")},
                        {"cause", kind.at("cause")},
                        {"settled", kind.at("settled")},
                        {"line", kind.at("line")},
                        {"case", case_of(answer, kind)},
                        {"pair", simplest.at("pair")},
                        {"sentences", simplest.at("sentences")}});
  }
  for (const strata::LeftOut& row : answer.left_out) left_out.push_back({{"stratum", row.id}, {"why", row.why}});
  Json json = {{"subject", answer.code.name},
               {"source", answer.code.what},
               {"lane", counts.lanes[lane].id},
               {"pairs", counts.total.pairs},
               {"seed", counts.seed},
               {"wrong", reports::to_json(share_of(counts.total.wrong(lane), counts.total.pairs))},
               {"wrong_by_group", groups},
               {"wrong_by_build", builds},
               {"failures", failures},
               {"epsilon", reports::epsilon_words(counts, lane, answer.kinds, answer.epsilon.named, answer.effect)},
               {"tune", answer.epsilon.tune},
               {"why_not_tuned", answer.epsilon.why_not},
               {"nanoseconds_a_call",
                {{"machine", fuzz::machine_name()},
                 {"pairs", answer.costs.pairs},
                 {"passes", kPassesOfCalls},
                 {"own", cost_json(answer.costs.own)},
                 {"exact", cost_json(answer.costs.exact)},
                 {"cheapest", cost_json(answer.costs.cheapest)}}},
               {"directory", answer.directory},
               {"scene", answer.scene},
               {"wrapper", answer.code.wrapper},
               {"strata_left_out", left_out},
               {"test", answer.test},
               {"earlier", answer.earlier},
               {"again", answer.again}};
  fuzz::add_left_out(json, under_test);
  return json;
}

std::string text_of(const Answer& answer, const reports::Screen& screen) {
  const reports::CampaignCounts counts = reports::counts_of(answer.summary);
  const std::size_t lane = reports::own_lanes(counts).front();
  std::vector<std::string> before = {reports::wrong_words(counts, lane), reports::wrong_by_kind(counts, lane)};
  if (const std::string builds = reports::other_builds(counts, lane); !builds.empty()) before.push_back(builds);
  if (answer.code.is_program && counts.total.pairs == kPairsOfProgram)
    before.push_back(fmt::format("A program answers slowly, so it got {} pairs; --pairs sets another number.",
                                 reports::grouped(kPairsOfProgram)));
  if (!answer.left_out.empty()) before.push_back(left_out_in_words(answer.left_out));
  std::vector<reports::ScreenFailure> failures;
  const std::uint64_t wrong = reports::wrong_pairs(answer.summary, answer.code.name);
  if (!answer.told.empty())
    before.push_back(reports::kinds_heading(counts, lane, answer.told.size(), answer.kinds.size(), wrong));
  for (const Json& kind : answer.told) {
    failures.push_back({reports::kind_title(kind, wrong), reports::pair_on_a_line(reports::pair_of_kind(kind)),
                        reports::kind_sentence(kind, counts.lanes[lane].id)});
  }
  std::vector<std::string> after = {
      reports::epsilon_words(counts, lane, answer.kinds, answer.epsilon.named, answer.effect)};
  if (counts.total.wrong(lane) > 0) {
    if (!answer.epsilon.why_not.empty()) after.push_back(answer.epsilon.why_not);
    if (!answer.epsilon.tune.empty()) after.push_back("Tune it: " + answer.epsilon.tune);
  }
  after.push_back(exact_in_words(*answer.costs.exact.lane, counts.lanes[lane], counts));
  const std::string costs = costs_in_words(answer.costs), &dir = answer.directory;
  after.push_back(costs);
  if (std::string text = not_covered_text(answer.summary["spec"]); !text.empty()) {
    text.pop_back();
    after.push_back(text);
  }
  if (!answer.earlier.empty())
    after.push_back(fmt::format("The earlier run is now {0}; to compare: graze report --compare {0} {1}",
                                path_word(answer.earlier), path_word(dir)));
  if (counts.lanes[lane].name.variant.starts_with("cuda"))
    after.push_back(fmt::format("CPU against GPU: graze discrepancy --campaign {}", path_word(dir)));
  std::vector<std::string> written = {dir + "/report.html"};
  if (!answer.told.empty()) written.push_back(case_of(answer, answer.told[0]));
  if (!answer.test.empty()) written.push_back(answer.test + " (a test)");
  for (const std::string& file : {answer.scene, answer.code.wrapper}) {
    if (!file.empty()) written.push_back(file);
  }
  after.push_back(fmt::format("Wrote {}", printable(fmt::format("{}", fmt::join(written, ", ")))));
  after.push_back(answer.told.empty()
                      ? fmt::format("Next, with more pairs: {}", answer.again)
                      : fmt::format("Next: graze explain {}", path_word(case_of(answer, answer.told[0]))));
  // The costs change with each run. The sentence always counts as kLinesOfCosts lines, so that the rest of the screen
  // stays the same.
  const std::string lines = reports::wrapped(costs, screen.columns, 0, 2);
  const auto unused = kLinesOfCosts - std::count(lines.begin(), lines.end(), '\n');
  return reports::one_screen(before, failures, after, screen,
                             kLinesOfScreen - static_cast<int>(std::max<std::ptrdiff_t>(unused, 0)));
}

}  // namespace graze::cli
