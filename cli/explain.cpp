// SPDX-License-Identifier: Apache-2.0
// `graze explain`: explains why lanes are wrong on a case, in numbers, and in one sentence for each algorithm.
#include "analysis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>

#include "analysis/pareto.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/screen.h"
#include "core/text.h"
#include "cuda/twin/twin.h"
#include "fuzz/minimise/kinds.h"
#include "reports/cost_words.h"
#include "reports/discrepancy.h"
#include "reports/terminal.h"
#include "subjects/cuda_code.h"

namespace graze::cli {
namespace {

// Whether a value's relative error is more than about a thousandth. Smaller errors are ordinary rounding, and are not
// shown.
bool is_off(const oracle::Beside& beside, Scalar scalar) {
  return !(beside.ulps <= std::ldexp(1e-3, scalar == Scalar::f32 ? 23 : 52));
}

// "guigue_devillers_2003.h:111"
std::string place(const analysis::Step& step) { return step.line.substr(step.line.rfind('/') + 1); }

// Formats one step: a value, with the exact value if it is off; or a comparison, with the exact values if its outcome
// differs. Marks the step that is reported. places: width of the column for the place.
std::string step_text(const analysis::Step& step, bool told, Scalar scalar, int places, const reports::Screen& screen) {
  std::string text = fmt::format("{}{:<{}}  ", told ? "   => " : "      ", place(step), places), exactly;
  const int hang = reports::width_of(text);
  constexpr const char* kUndefined = "no exact value, after a division by exactly zero";
  if (step.relation.empty()) {
    text += fmt::format("{}: {:.7g}", step.site, step.left.lane);
    if (is_off(step.left, scalar)) exactly = std::isnan(step.left.exact) ? kUndefined : "exactly " + step.left.decimal;
  } else {
    text += fmt::format("{:.7g} {} {:.7g} is {}", step.left.lane, step.relation, step.right.lane, step.held);
    if (step.wrong())
      exactly = step.is_undefined() ? kUndefined
                                    : fmt::format("exactly {} {} {} is {}", step.left.decimal, step.relation,
                                                  step.right.decimal, step.holds);
  }
  if (!exactly.empty()) {
    const bool fits = reports::width_of(text) + 2 + reports::width_of(exactly) <= screen.columns;
    text += (step.relation.empty() ? "," : ";") +
            (fits ? " " : "\n" + std::string(static_cast<std::size_t>(hang), ' ')) + exactly;
  }
  return (told ? reports::red(screen, text) : text) + '\n';
}

// Formats the values up to the reported comparison, or all values if no comparison is reported. Shows only the last
// kMost of these values.
std::string steps_text(const analysis::LaneExplanation& lane, const reports::Screen& screen) {
  constexpr int kMost = 12;
  if (lane.evidence == analysis::Evidence::none)
    return "    values: unknown, because no contraction rule replays this lane here\n";
  const analysis::Step* told = lane.told();
  const int end = told ? static_cast<int>(told - lane.steps.data()) + 1 : static_cast<int>(lane.steps.size());
  const int begin = std::max(0, end - kMost);
  const std::string_view known = lane.evidence == analysis::Evidence::source ? ""
                                 : lane.evidence == analysis::Evidence::hash
                                     ? " (contracted by a rule; their trace hash is that of the lane's twin)"
                                     : " (contracted by a rule; only the verdict is known to be the lane's)";
  const std::string before = begin > 0 ? fmt::format(" ({} before, see --json)", begin) : "";
  std::string text = reports::wrapped(fmt::format("values{}{}:", known, before), screen.columns, 4, 6);
  const auto shown =
      std::span(lane.steps).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  std::size_t places = 0;
  for (const analysis::Step& step : shown) places = std::max(places, place(step).size());
  for (const analysis::Step& step : shown)
    text += step_text(step, &step == told, lane.lane->scalar, static_cast<int>(places), screen);
  for (const analysis::Step& step : lane.then)
    text += step_text(step, true, lane.lane->scalar, static_cast<int>(places), screen);
  const bool all_right =
      std::none_of(lane.steps.begin(), lane.steps.end(), [](const analysis::Step& step) { return step.wrong(); });
  return text + (all_right ? "      every comparison has the same outcome as in exact arithmetic\n" : "");
}

// "a[0].x b[2].z"
std::string free_coordinates(const analysis::LaneExplanation& lane) {
  std::string names;
  for (int c = 0; c < kCoordinates; ++c) {
    if (lane.matters[static_cast<std::size_t>(c)]) continue;
    names += fmt::format(" {}[{}].{}", c < 9 ? 'a' : 'b', c / 3 % 3, "xyz"[c % 3]);
  }
  const bool all = std::none_of(lane.matters.begin(), lane.matters.end(), [](bool matters) { return matters; });
  return names.empty() ? " none" : all ? " each of them, alone" : names;
}

std::string lane_text(const AnyPair& pair, const analysis::LaneExplanation& lane,
                      const analysis::LaneExplanation* before, const reports::Screen& screen) {
  std::string text;
  const auto line = [&](int indent, const std::string& words) {
    text += reports::wrapped(words, screen.columns, indent, indent + 2);
  };
  const auto surroundings = [&] {
    line(4, "coordinates that may move by an ulp or by 2^-10 of their size without effect:" + free_coordinates(lane));
    line(4, fmt::format("wrong in {} of {} orders, {} of {} mirror images, {} of {} scalings by 2^-{}…2^{}",
                        lane.orders.wrong, lane.orders.of, lane.mirrored.wrong, lane.mirrored.of, lane.scalings.wrong,
                        lane.scalings.of, analysis::kMostScaling, analysis::kMostScaling));
  };
  const auto contractions = [&] {
    if (lane.contractions.sites.empty()) return;
    line(4, fmt::format("contractions, {}:", lane.contractions.smallest ? "the smallest set that makes the difference"
                                                                        : "several sets that each suffice"));
    for (const cuda::ContractionSite& site : lane.contractions.sites) {
      const std::string inlined =
          *site.from.file == '\0' ? "" : fmt::format(", inlined at {}:{}", site.from.file, site.from.line);
      line(6, fmt::format("{}:{}{}, by {}", site.at.file, site.at.line, inlined,
                          site.by_ptxas ? "ptxas" : "nvcc's front end"));
    }
  };
  line(2, fmt::format("{}: {}, cause: {}{}", lane.lane->id, name(lane.verdict), name(lane.cause),
                      lane.settled == analysis::Settled::yes ? "" : " (not settled)"));
  if (lane.by_experiment()) {
    line(4, "experiment: " + lane.experiment);
    contractions();
    if (!lane.slow) surroundings();
    return text;
  }
  const auto steps = [](const analysis::LaneExplanation& l) { return to_json(l)["steps"]; };
  if (before && before->lane->info == lane.lane->info && before->lane->scalar == lane.lane->scalar &&
      lane.evidence == analysis::Evidence::source && steps(*before) == steps(lane)) {
    text += fmt::format("    values: those of {}\n", before->lane->id);
  } else {
    text += steps_text(lane, screen);
  }
  contractions();
  const bool stored = analysis::decides_stored(*lane.lane, pair);
  line(4, fmt::format("mantissa bits needed for the right verdict{}: {}", stored ? " on the stored pair" : "",
                      lane.cause == analysis::Cause::logic ? "no number of bits helps"
                      : lane.bits_needed == 0              ? fmt::format("none up to {} is known", oracle::kMostBits)
                                                           : fmt::format("{}{}", lane.bits_needed,
                                                            lane.bits_alone ? "" : ", with unlimited exponents")));
  surroundings();
  return text;
}

// Returns the runs of two lanes side by side if the user named exactly two and both record their values; otherwise
// empty. Also empty for lanes in float on a pair of doubles.
std::string side_by_side(const std::vector<const Lane*>& lanes, const AnyPair& pair, const reports::Screen& screen) {
  if (lanes.size() != 2 || !is_finite(pair.doubles) || analysis::decides_stored(*lanes[0], pair) ||
      !analysis::why_not_compared(*lanes[0], *lanes[1]).empty())
    return "";
  return '\n' + reports::side_by_side({*lanes[0], *lanes[1]}, pair, screen);
}

// Returns the cost of two kernels of the user's code: the lane's own kernel, and one built with -fmad=false.
std::string cost_of_rounding(const std::string& lane) {
  const std::string rounded = fmt::format("{}/{}", lane.substr(0, lane.rfind('/')), name(Variant::cuda_nofma));
  std::vector<const cuda::CudaBuild*> builds;
  for (const std::string& id : {rounded, lane}) {
    for (const cuda::NamedBuild& named : subjects::cuda_builds())
      if (named.lane == id) builds.push_back(named.build);
  }
  try {
    const subjects::KernelCosts costs = subjects::kernel_costs(builds);
    return fmt::format("Cost per pair on {}, measured on {} of the stratum uniform in its memory: {} {}, {} {}.",
                       printable(costs.device), reports::counted(subjects::kPairsOfKernelCosts, "pair"), rounded,
                       reports::cost_words(analysis::quartiles(costs.nanoseconds.at(0))), lane,
                       reports::cost_words(analysis::quartiles(costs.nanoseconds.at(1))));
  } catch (const std::runtime_error& error) {
    return fmt::format("Cost of -fmad=false: not measured, because {}.", printable(error.what()));
  }
}

struct ExplainOptions {
  std::string name;
  LaneOptions lanes;
  bool json = false;
  bool exact_input = false;
  bool all = false;
};

// Returns the conclusion about a case, in blocks of lines.
std::vector<std::string> answer_of(const ExplainOptions& options, const fuzz::SelectedLanes& under_test,
                                   const corpus::Entry& entry, const analysis::Explanation& explanation,
                                   const reports::Screen& screen) {
  std::vector<std::string> blocks = {
      fmt::format("{}{}\n", printable(options.name), entry.line > 0 ? fmt::format(":{}", entry.line) : "")};
  const std::vector<std::string> sentences = analysis::sentences(explanation);
  for (const std::string& sentence : sentences)
    blocks.push_back(reports::bold(screen, reports::wrapped(sentence, screen.columns, 2, 4)));
  const auto tells = std::find_if(sentences.begin(), sentences.end(), analysis::tells_difference_from_cpu);
  if (tells != sentences.end())
    blocks.push_back(reports::wrapped(cost_of_rounding(tells->substr(0, tells->find(' '))), screen.columns, 2, 4));
  for (const std::string& text :
       {written_note(entry, explanation.truth), stored_verdicts(entry, under_test.left_out, explanation.truth.verdict)})
    if (!text.empty()) blocks.push_back(reports::wrapped(text, screen.columns, 2, 4));
  if (explanation.lanes.empty()) {
    blocks.push_back(explanation.truth.verdict == Verdict::declined
                         ? "  nothing to explain: a coordinate is not finite, and no verdict is right\n"
                         : "  nothing to explain: no lane is wrong\n");
  }
  return blocks;
}

// Returns the details: the pair with all verdicts, two lanes side by side, and each wrong lane's values.
std::vector<std::string> details_of(const fuzz::SelectedLanes& under_test, const analysis::Explanation& explanation,
                                    const reports::Screen& screen) {
  std::ostringstream pair;
  visit(explanation.pair, [&](const auto& own) {
    reports::print_pair(pair, own, explanation.truth, under_test.lanes, decide(under_test, explanation.pair), screen);
  });
  std::vector<std::string> blocks = {'\n' + pair.str(), side_by_side(under_test.lanes, explanation.pair, screen)};
  const analysis::LaneExplanation* before = nullptr;
  for (const analysis::LaneExplanation& lane : explanation.lanes) {
    blocks.push_back('\n' + lane_text(explanation.pair, lane, before, screen));
    if (lane.lane->variant == Variant::cpu) before = &lane;
  }
  return blocks;
}

void print_json(const ExplainOptions& options, const fuzz::SelectedLanes& under_test, const corpus::Entry& entry,
                const analysis::Explanation& explanation) {
  nlohmann::ordered_json line{
      {"case", options.name}, {"line", entry.line}, {"pair", fuzz::pair_text(corpus::pair_of(entry))}};
  line.update(to_json(explanation));
  line["cuda"] = cuda_evidence(under_test);
  fuzz::add_left_out(line, under_test);
  if (const std::string note = written_note(entry, explanation.truth); !note.empty()) line["note"] = note;
  // JSON requires valid UTF-8, which a file name need not be.
  fmt::print("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void explain_cases(const ExplainOptions& options) {
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes, options.name);
  fuzz::put_own_code_first(under_test);
  const reports::Screen screen = output_screen();
  const std::vector<corpus::Entry> entries = read_cases(options.name, options.exact_input);
  take_doubles_of(entries, under_test);
  // Two lines of the limit are reserved for the text that follows.
  LimitedText limited(options.all ? std::numeric_limits<int>::max() : kMostLines - 2);
  const auto add = [&](const std::vector<std::string>& blocks) {
    for (const std::string& block : blocks) limited.add(block);
  };
  std::vector<std::string> details;  // of the first case
  bool wrong = false;
  for (std::size_t e = 0; e < entries.size() && limited.complete(); ++e) {
    const corpus::Entry& entry = entries[e];
    const analysis::Explanation explanation = analysis::explain(corpus::pair_of(entry), under_test.lanes);
    wrong = wrong || !explanation.lanes.empty();
    if (options.json) {
      print_json(options, under_test, entry, explanation);
      continue;
    }
    add(answer_of(options, under_test, entry, explanation, screen));
    if (options.all) {
      add(details_of(under_test, explanation, screen));
      fmt::print("{}", limited.text());
      std::fflush(stdout);
      limited = LimitedText(std::numeric_limits<int>::max());
    } else if (e == 0) {
      details = details_of(under_test, explanation, screen);
    }
  }
  if (options.json) return;
  add(details);
  fmt::print("{}", limited.text());
  if (!options.all && (!limited.complete() || entries.size() > 1))
    fmt::print("--all explains {} in full\n", reports::counted(entries.size(), "case"));
  if (wrong) fmt::print("Next: graze map {}{}\n", path_word(options.name), own_words(options.lanes));
}

}  // namespace

void add_explain(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "explain",
      "Explain why lanes are wrong on a case: their values beside the exact ones, the cause, and what would help");
  command->footer("Example: graze explain near_edge_edge:1:7");
  auto options = std::make_shared<ExplainOptions>();
  command->add_option("CASE", options->name, "File of pairs, or STRATUM:SEED:INDEX")->required();
  add_lane_options(*command, options->lanes, Executors::twins);
  add_resubject_option(*command, options->lanes);
  add_exact_input(*command, options->exact_input);
  command->add_flag("--all", options->all, "Print all cases, verdicts and values, however many lines they take");
  command->add_flag("--json", options->json, "Print one JSON object per line, one line per case, with all values");
  command->callback([options] { explain_cases(*options); });
}

}  // namespace graze::cli
