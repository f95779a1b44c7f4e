// SPDX-License-Identifier: Apache-2.0
// `graze explain`: why each wrong lane is wrong on a case, in numbers and in one sentence for each algorithm.
#include "analysis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "cli/cases.h"
#include "cli/commands.h"
#include "core/text.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

std::string words(const oracle::Beside& beside) {
  const std::string error = std::isinf(beside.ulps) ? "" : fmt::format("  {:.3g} ulps", beside.ulps);
  return fmt::format("{:<14.7g} exact {:<14}{}", beside.lane, beside.decimal, error);
}

void print_step(const analysis::Step& step) {
  fmt::print("      {:<34} {:<15}", step.line, step.site);
  if (step.relation.empty()) {
    fmt::print("{}\n", words(step.left));
    return;
  }
  fmt::print("{:.7g} {} {:.7g} is {}; exact {} {} {} is {}; difference {}{}\n", step.left.lane, step.relation,
             step.right.lane, step.held, step.left.decimal, step.relation, step.right.decimal, step.holds,
             words(step.difference), step.wrong() ? "  WRONG" : "");
}

// The values up to the comparison to tell of, or all; at most the last kMost of them.
void print_steps(const analysis::LaneExplanation& lane) {
  constexpr int kMost = 12;
  const analysis::Step* told = lane.told();
  const int end = told ? static_cast<int>(told - lane.steps.data()) + 1 : static_cast<int>(lane.steps.size());
  const int begin = std::max(0, end - kMost);
  fmt::print("    values{}:{}\n",
             lane.evidence == analysis::Evidence::source ? ""
             : lane.evidence == analysis::Evidence::hash
                 ? " (contracted by a rule; they have the hash of the lane's twin)"
             : lane.evidence == analysis::Evidence::verdict
                 ? " (contracted by a rule; only the verdict is known to be the lane's)"
                 : ": unknown, no rule of contraction replays this lane here",
             begin > 0 ? fmt::format(" ({} before, see --json)", begin) : "");
  for (int i = begin; i < end; ++i) print_step(lane.steps[static_cast<std::size_t>(i)]);
  if (lane.first_wrong < 0 && lane.evidence != analysis::Evidence::none)
    fmt::print("      every comparison goes as in exact arithmetic\n");
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

void print_lane(const analysis::LaneExplanation& lane, const analysis::LaneExplanation* before) {
  fmt::print("  {}: {}, cause: {}\n", lane.lane->id, name(lane.verdict), name(lane.cause));
  const auto steps = [](const analysis::LaneExplanation& l) { return to_json(l)["steps"]; };
  if (before && before->lane->info == lane.lane->info && before->lane->scalar == lane.lane->scalar &&
      lane.evidence == analysis::Evidence::source && steps(*before) == steps(lane)) {
    fmt::print("    values: those of {}\n", before->lane->id);
  } else {
    print_steps(lane);
  }
  if (!lane.contractions.sites.empty()) {
    fmt::print("    contractions, {}:\n", lane.contractions.smallest ? "the smallest set that makes the difference"
                                                                     : "none of which can be spared");
    for (const cuda::ContractionSite& site : lane.contractions.sites) {
      fmt::print("      {}:{}, inlined at {}:{}, by {}\n", site.at.file, site.at.line, site.from.file, site.from.line,
                 site.by_ptxas ? "ptxas" : "nvcc's front end");
    }
  }
  fmt::print("    mantissa bits it would have needed: {}\n",
             lane.cause == analysis::Cause::logic ? "no number of bits helps"
             : lane.bits_needed == 0              ? fmt::format("more than {}", oracle::kMostBits)
                                                  : fmt::format("{}", lane.bits_needed));
  fmt::print("    coordinates that do not matter:{}\n", free_coordinates(lane));
  fmt::print("    wrong in {} of {} orders, {} of {} mirror images, {} of {} scalings by 2^-{}…2^{}\n",
             lane.orders.wrong, lane.orders.of, lane.mirrored.wrong, lane.mirrored.of, lane.scalings.wrong,
             lane.scalings.of, analysis::kMostScaling, analysis::kMostScaling);
}

struct ExplainOptions {
  std::string name;
  std::vector<std::string> globs;
  bool json = false;
  bool exact_input = false;
};

void explain_cases(const ExplainOptions& options) {
  const fuzz::LanesUnderTest under_test = fuzz::select_lanes(options.globs, fuzz::Executor::twin);
  bool wrong = false;
  for (const corpus::Entry& entry : read_cases(options.name)) {
    if (options.exact_input) expect_exact_input(options.name, entry);
    const analysis::Explanation explanation = analysis::explain(entry.pair, under_test.lanes);
    if (options.json) {
      nlohmann::ordered_json line{{"case", options.name}, {"line", entry.line}};
      line.update(to_json(explanation));
      line["cuda"] = cuda_evidence(under_test);
      if (const std::string note = written_note(entry, explanation.truth); !note.empty()) line["note"] = note;
      // A file's name need not be UTF-8, as JSON must.
      fmt::print("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
      continue;
    }
    fmt::print("{}{}\n", options.name, entry.line > 0 ? fmt::format(":{}", entry.line) : "");
    std::fflush(stdout);
    reports::print_pair(std::cout, entry.pair, explanation.truth, under_test.lanes, decide(under_test, entry.pair));
    std::cout.flush();
    if (const std::string note = written_note(entry, explanation.truth); !note.empty()) fmt::print("  {}\n", note);
    const analysis::LaneExplanation* before = nullptr;
    for (const analysis::LaneExplanation& lane : explanation.lanes) {
      print_lane(lane, before);
      if (lane.lane->variant == Variant::cpu) before = &lane;
    }
    if (explanation.lanes.empty()) {
      fmt::print("  {}\n", explanation.truth.verdict == Verdict::declined
                               ? "nothing to explain: a coordinate is not finite, and no verdict is right"
                               : "nothing to explain: no lane is wrong");
    }
    for (const std::string& text : analysis::sentences(explanation)) fmt::print("  {}\n", text);
    wrong = wrong || !explanation.lanes.empty();
  }
  if (wrong) fmt::print("Next: graze map {}\n", shell_word(options.name));
}

}  // namespace

void add_explain(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "explain",
      "Say why lanes are wrong on a case: their values beside the exact ones, the cause, and what would help");
  command->footer("Example: graze explain near_edge_edge:1:7");
  auto options = std::make_shared<ExplainOptions>();
  command->add_option("case", options->name, "A file of pairs, or STRATUM:SEED:INDEX")->required();
  add_globs(*command, "--lanes", options->globs, "Only lanes that match a pattern");
  add_exact_input(*command, options->exact_input);
  command->add_flag("--json", options->json, "One JSON object for each case, on a line of its own, with all values");
  command->callback([options, &status] {
    explain_cases(*options);
    status = 0;
  });
}

}  // namespace graze::cli
