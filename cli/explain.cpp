// SPDX-License-Identifier: Apache-2.0
// `graze explain`: explains why lanes are wrong on a case, in numbers, and in one sentence for each algorithm.
#include "analysis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <span>

#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/screen.h"
#include "core/text.h"
#include "cuda/twin/twin.h"
#include "fuzz/minimise/kinds.h"
#include "reports/side_by_side.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

// Whether a value is off by more than a thousandth. Rounding explains smaller errors, so they tell nothing.
bool is_off(const oracle::Beside& beside, Scalar scalar) {
  return !(beside.ulps <= std::ldexp(1e-3, scalar == Scalar::f32 ? 23 : 52));
}

// "guigue_devillers_2003.h:111"
std::string place(const analysis::Step& step) { return step.line.substr(step.line.rfind('/') + 1); }

// Prints a value, with the exact value if it is off, or a comparison, with the exact values if its outcome differs.
// Marks the step to report. places: width of the column for the place.
void print_step(const analysis::Step& step, bool told, Scalar scalar, int places, const reports::Screen& screen) {
  std::string text = fmt::format("{}{:<{}}  ", told ? "   => " : "      ", place(step), places), exactly;
  const int hang = reports::width_of(text);
  if (step.relation.empty()) {
    text += fmt::format("{}: {:.7g}", step.site, step.left.lane);
    if (is_off(step.left, scalar)) exactly = "exactly " + step.left.decimal;
  } else {
    text += fmt::format("{:.7g} {} {:.7g} is {}", step.left.lane, step.relation, step.right.lane, step.held);
    if (step.wrong())
      exactly = fmt::format("exactly {} {} {} is {}", step.left.decimal, step.relation, step.right.decimal, step.holds);
  }
  if (!exactly.empty()) {
    const bool fits = reports::width_of(text) + 2 + reports::width_of(exactly) <= screen.columns;
    text += (step.relation.empty() ? "," : ";") +
            (fits ? " " : "\n" + std::string(static_cast<std::size_t>(hang), ' ')) + exactly;
  }
  fmt::print("{}\n", told ? reports::red(screen, text) : text);
}

// Prints the values up to the reported comparison, or all values if there is none; of these only the last kMost.
void print_steps(const analysis::LaneExplanation& lane, const reports::Screen& screen) {
  constexpr int kMost = 12;
  if (lane.evidence == analysis::Evidence::none) {
    fmt::print("    values: unknown, because no contraction rule replays this lane here\n");
    return;
  }
  const analysis::Step* told = lane.told();
  const int end = told ? static_cast<int>(told - lane.steps.data()) + 1 : static_cast<int>(lane.steps.size());
  const int begin = std::max(0, end - kMost);
  const std::string_view known = lane.evidence == analysis::Evidence::source ? ""
                                 : lane.evidence == analysis::Evidence::hash
                                     ? " (contracted by a rule; they have the hash of the lane's twin)"
                                     : " (contracted by a rule; only the verdict is known to be the lane's)";
  const std::string before = begin > 0 ? fmt::format(" ({} before, see --json)", begin) : "";
  fmt::print("{}", reports::wrapped(fmt::format("values{}{}:", known, before), screen.columns, 4, 6));
  const auto shown =
      std::span(lane.steps).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  std::size_t places = 0;
  for (const analysis::Step& step : shown) places = std::max(places, place(step).size());
  for (const analysis::Step& step : shown)
    print_step(step, &step == told, lane.lane->scalar, static_cast<int>(places), screen);
  for (const analysis::Step& step : lane.then)
    print_step(step, true, lane.lane->scalar, static_cast<int>(places), screen);
  const bool all_right =
      std::none_of(lane.steps.begin(), lane.steps.end(), [](const analysis::Step& step) { return step.wrong(); });
  if (all_right) fmt::print("      every comparison goes as in exact arithmetic\n");
}

// "a[0].x b[2].z"
std::string free_coordinates(const analysis::LaneExplanation& lane) {
  std::string names;
  for (int c = 0; c < kCoordinates; ++c) {
    if (lane.matters[static_cast<std::size_t>(c)]) continue;
    names += fmt::format(" {}[{}].{}", c < 9 ? 'a' : 'b', c / 3 % 3, "xyz"[c % 3]);
  }
  return names.empty() ? " none" : names;
}

void print_surroundings(const analysis::LaneExplanation& lane,
                        const std::function<void(int indent, const std::string& text)>& line) {
  line(4, "coordinates that do not matter:" + free_coordinates(lane));
  line(4, fmt::format("wrong in {} of {} orders, {} of {} mirror images, {} of {} scalings by 2^-{}…2^{}",
                      lane.orders.wrong, lane.orders.of, lane.mirrored.wrong, lane.mirrored.of, lane.scalings.wrong,
                      lane.scalings.of, analysis::kMostScaling, analysis::kMostScaling));
}

void print_contractions(const analysis::LaneExplanation& lane,
                        const std::function<void(int indent, const std::string& text)>& line) {
  if (lane.contractions.sites.empty()) return;
  line(4, fmt::format("contractions, {}:", lane.contractions.smallest ? "the smallest set that makes the difference"
                                                                      : "sets of which each is enough"));
  for (const cuda::ContractionSite& site : lane.contractions.sites) {
    const std::string inlined =
        *site.from.file == '\0' ? "" : fmt::format(", inlined at {}:{}", site.from.file, site.from.line);
    line(6, fmt::format("{}:{}{}, by {}", site.at.file, site.at.line, inlined,
                        site.by_ptxas ? "ptxas" : "nvcc's front end"));
  }
}

void print_lane(const analysis::LaneExplanation& lane, const analysis::LaneExplanation* before,
                const reports::Screen& screen) {
  const auto line = [&](int indent, const std::string& text) {
    fmt::print("{}", reports::wrapped(text, screen.columns, indent, indent + 2));
  };
  line(2, fmt::format("{}: {}, cause: {}{}", lane.lane->id, name(lane.verdict), name(lane.cause),
                      lane.settled == analysis::Settled::yes ? "" : " (not settled)"));
  if (lane.lane->foreign || lane.lane->under) {
    line(4, "experiment: " + lane.experiment);
    print_contractions(lane, line);
    if (lane.slow) return;
    print_surroundings(lane, line);
    return;
  }
  const auto steps = [](const analysis::LaneExplanation& l) { return to_json(l)["steps"]; };
  if (before && before->lane->info == lane.lane->info && before->lane->scalar == lane.lane->scalar &&
      lane.evidence == analysis::Evidence::source && steps(*before) == steps(lane)) {
    fmt::print("    values: those of {}\n", before->lane->id);
  } else {
    print_steps(lane, screen);
  }
  print_contractions(lane, line);
  line(4, fmt::format("mantissa bits it would have needed: {}",
                      lane.cause == analysis::Cause::logic ? "no number of bits helps"
                      : lane.bits_needed == 0              ? fmt::format("more than {}", oracle::kMostBits)
                                                           : fmt::format("{}", lane.bits_needed)));
  print_surroundings(lane, line);
}

// Prints the runs of two lanes side by side, if the user named exactly two and both record their values.
void print_side_by_side(const std::vector<const Lane*>& lanes, const Pair& pair, const reports::Screen& screen) {
  if (lanes.size() != 2 || !is_finite(pair) || !analysis::why_not_compared(*lanes[0], *lanes[1]).empty()) return;
  fmt::print("\n{}", reports::side_by_side({*lanes[0], *lanes[1]}, pair, screen));
}

struct ExplainOptions {
  std::string name;
  LaneOptions lanes;
  bool json = false;
  bool exact_input = false;
};

void explain_cases(const ExplainOptions& options) {
  const fuzz::SelectedLanes under_test = selected_lanes(options.lanes, options.name);
  const reports::Screen screen = output_screen();
  bool wrong = false;
  for (const corpus::Entry& entry : read_cases(options.name)) {
    if (options.exact_input) expect_exact_input(options.name, entry);
    const analysis::Explanation explanation = analysis::explain(entry.pair, under_test.lanes);
    if (options.json) {
      nlohmann::ordered_json line{{"case", options.name}, {"line", entry.line}, {"pair", fuzz::pair_text(entry.pair)}};
      line.update(to_json(explanation));
      line["cuda"] = cuda_evidence(under_test);
      if (const std::string note = written_note(entry, explanation.truth); !note.empty()) line["note"] = note;
      // A file name may not be valid UTF-8, which JSON requires.
      fmt::print("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
      continue;
    }
    fmt::print("{}{}\n", options.name, entry.line > 0 ? fmt::format(":{}", entry.line) : "");
    // The conclusion comes first.
    for (const std::string& text : analysis::sentences(explanation))
      fmt::print("{}", reports::bold(screen, reports::wrapped(text, screen.columns, 2, 4)));
    if (const std::string note = written_note(entry, explanation.truth); !note.empty())
      fmt::print("{}", reports::wrapped(note, screen.columns, 2, 4));
    if (explanation.lanes.empty()) {
      fmt::print("  {}\n", explanation.truth.verdict == Verdict::declined
                               ? "nothing to explain: a coordinate is not finite, and no verdict is right"
                               : "nothing to explain: no lane is wrong");
    }
    fmt::print("\n");
    std::fflush(stdout);
    reports::print_pair(std::cout, entry.pair, explanation.truth, under_test.lanes, decide(under_test, entry.pair),
                        screen);
    std::cout.flush();
    const analysis::LaneExplanation* before = nullptr;
    for (const analysis::LaneExplanation& lane : explanation.lanes) {
      fmt::print("\n");
      print_lane(lane, before, screen);
      if (lane.lane->variant == Variant::cpu) before = &lane;
    }
    print_side_by_side(under_test.lanes, entry.pair, screen);
    wrong = wrong || !explanation.lanes.empty();
  }
  if (wrong) fmt::print("Next: graze map {}\n", path_word(options.name));
}

}  // namespace

void add_explain(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "explain",
      "Explain why lanes are wrong on a case: their values beside the exact ones, the cause, and what would help");
  command->footer("Example: graze explain near_edge_edge:1:7");
  auto options = std::make_shared<ExplainOptions>();
  command->add_option("CASE", options->name, "File of pairs, or STRATUM:SEED:INDEX")->required();
  add_lane_options(*command, options->lanes, Executors::twins);
  add_exact_input(*command, options->exact_input);
  command->add_flag("--json", options->json, "Print one JSON object per line, one line per case, with all values");
  command->callback([options, &status] {
    explain_cases(*options);
    status = 0;
  });
}

}  // namespace graze::cli
