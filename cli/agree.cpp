// SPDX-License-Identifier: Apache-2.0
// `graze tune LANE LANE --agree`: finds the smallest tolerance under which two lanes give the same verdicts.
#include <fmt/format.h>

#include <algorithm>

#include "backends/backends.h"
#include "cli/screen.h"
#include "cli/tune.h"
#include "core/error.h"
#include "fuzz/sealed.h"
#include "reports/agreement.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

// Throws: UsageError for a lane that does not run on this host.
void expect_on_host(const Lane& lane) {
  if (const std::string why = backends::why_not_on_host(lane); !why.empty())
    throw UsageError("--agree cannot run " + lane.id + " on this host (" + why + "); choose another lane");
}

// Returns the lane's variant that rounds every operation as written.
const Lane& rounded(const Lane& lane) { return *counterpart(lane, rounded_variant(lane.variant)); }

}  // namespace

int agree(const TuneOptions& options) {
  if (!options.own_code.subjects.empty())
    throw UsageError(
        "--agree sets tolerances, which only published algorithms have; for your own code `graze discrepancy` shows "
        "where two builds differ, and `graze tune LANE` tunes the epsilon");
  const Lane &first = published_lane(options.lanes[0]), &second = published_lane(options.lanes[1]);
  if (first.algorithm != second.algorithm || first.scalar != second.scalar)
    throw UsageError("--agree needs two lanes of the same algorithm and scalar, but got " + first.id + " and " +
                     second.id);
  reports::AgreeQuestion question{{first.id, second.id}, {}, "", "", options.max_rate};
  for (const Lane* lane : {&first, &second}) {
    expect_on_host(*lane);
    if (!backends::on_host(lane_under(*lane, "abs:1")))
      throw UsageError("this build has no twin of " + lane->id + " with tolerances; scripts/setup builds such twins");
    if (!backends::on_host(lane_under(*lane, "rel:1"))) question.without_relative = lane->id;
  }
  analysis::AgreeSpec spec;
  spec.sweep = analysis::agreement_sweep(first, second, options.threads);
  std::vector<const Lane*> costly;
  const auto add_cost_of = [&](const Lane& lane) {
    if (std::find(costly.begin(), costly.end(), &lane) == costly.end()) costly.push_back(&lane);
  };
  add_cost_of(first);
  add_cost_of(second);
  if (&rounded(first) != &first || &rounded(second) != &second) {
    spec.rounded = analysis::agreement_sweep(rounded(first), rounded(second), options.threads);
    question.rounded = {rounded(first).id, rounded(second).id};
    for (const Lane* lane : {&first, &second}) {
      const Lane& mended = rounded(*lane);
      if (&mended == lane) continue;
      const std::string_view flags = info_of(mended.variant).flags;
      question.flag = flags.substr(flags.rfind(' ') + 1);  // the last flag turns contraction off
      add_cost_of(mended);
    }
  }
  TunePairs pairs = tune_pairs(options);
  for (const Lane* lane : {&first, &second}) expect_takes(*lane, pairs);
  const Lane* const exact[] = {&exact_on(pairs, first), &exact_on(pairs, second)};
  question.exact_scalar = name(exact[0]->scalar);
  spec.sources = std::move(pairs.sources);
  spec.others = std::move(pairs.others);
  spec.sites = analysis::sites_asked(first, spec.sources);
  spec.relative = question.without_relative.empty();
  spec.max_rate = options.max_rate;
  const ResultFolder folder(options.out.empty() ? "agreed" : options.out, "agree.json");
  const analysis::Agreed agreed = analysis::agree(spec);

  const reports::Screen screen = output_screen();
  print_wrapped(reports::agreement_sentences(question, agreed));
  fmt::print("\n{}{}\n", reports::agreement_table(question, agreed, screen), pairs.left_out);
  const std::string& policy = agreed.chosen;
  const std::vector<Lane> under = {policy.empty() ? first : lane_under(first, policy),
                                   policy.empty() ? second : lane_under(second, policy)};
  for (const Lane& lane : under) {
    if (!policy.empty() && lane.id != costly.back()->id) add_cost_of(lane);
  }
  for (const Lane* lane : exact) add_cost_of(*lane);
  print_wrapped(cost_sentences(costly, spec.others));

  std::vector<Result> results = {{"agree.json", fuzz::sealed(reports::agreement_json(question, agreed)).dump(1) + "\n"},
                                 {"curves.svg", reports::agreement_figure(question, agreed)}};
  if (const auto& place = agreed.zero_confirmed.first)
    results.push_back({"differ.pairs", smallest(first, second, pair_at(spec.others, *place))});
  if (const auto& place = agreed.confirmed.first; place && !policy.empty())
    results.push_back({"differ_under.pairs", smallest(under[0], under[1], pair_at(spec.others, *place))});
  const bool last_is_under = results.back().name == "differ_under.pairs";
  write_listed(folder.path, results, {{"differ.pairs", kPairs}, {"differ_under.pairs", kPairs}});
  fmt::print("{}", next_command(folder.path, results.back(),
                                last_is_under ? under[0].id + "," + under[1].id : first.id + "," + second.id));
  return 0;
}

}  // namespace graze::cli
