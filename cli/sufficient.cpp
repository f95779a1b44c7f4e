// SPDX-License-Identifier: Apache-2.0
// `graze scene --sufficient RATE`: tunes every published host lane in the scene, and compares those within the rate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/pareto.h"
#include "analysis/tuning.h"
#include "cli/commands.h"
#include "cli/screen.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/selected_lanes.h"
#include "reports/cost_words.h"
#include "reports/sufficient.h"
#include "reports/terminal.h"

namespace graze::cli {

namespace {

using reports::Candidate;

constexpr std::size_t kTimed = 8192;  // pairs
constexpr int kPasses = 9;

// Without an error, 3 / rate pairs are enough to show the rate; more pairs leave room for some errors.
std::uint64_t pairs_for(double rate) { return std::max<std::uint64_t>(100'000, std::llround(std::ceil(6 / rate))); }

// Draws the pairs on which the choice is made or judged. Leaves out a mesh's own pairs: they do not depend on the seed,
// and they are reserved for the final confirmation.
std::vector<strata::PairSource> pairs_before(const std::string& scene, std::uint64_t seed, std::uint64_t pairs,
                                             PairTypes types) {
  std::vector<strata::PairSource> sources = drawn({pairs, seed, {}, types, scene}).sources;
  std::erase_if(sources, [](const strata::PairSource& source) { return fuzz::is_of_mesh(source.id); });
  return sources;
}

}  // namespace

void print_sufficient(const std::string& scene, double rate) {
  const PairTypes types = type_of_scene(scene);
  const std::uint64_t pairs = pairs_for(rate);
  analysis::TuneSpec spec;
  spec.sources = pairs_before(scene, 1, pairs / 10, types);
  spec.others = pairs_before(scene, 2, pairs, types);
  spec.max_rate = rate;
  std::vector<Candidate> candidates;
  std::vector<Lane> lanes;  // with their tolerances
  for (const Lane& lane : published_lanes()) {
    if (lane.exact || lane.variant != Variant::cpu) continue;
    spec.sweep = analysis::host_sweep(lane);
    spec.sites = analysis::sites_asked(lane, spec.sources);
    const analysis::Tuned tuned = analysis::tune(spec);
    lanes.push_back(tuned.chosen.empty() ? lane : lane_under(lane, tuned.chosen));
    candidates.push_back({lanes.back().id, lane.scalar, tuned.result, tuned.confirmed, tuned.bound, {}});
    // The lane without a tolerance is cheaper, so it is a candidate too if its own rate is low enough.
    const double bound = analysis::upper_bound(tuned.zero_confirmed.wrong(), tuned.zero_confirmed.pairs);
    if (tuned.chosen.empty() || bound > rate) continue;
    lanes.push_back(lane);
    candidates.push_back({lane.id, lane.scalar, analysis::TuneResult::satisfied, tuned.zero_confirmed, bound, {}});
  }
  const Lane& exact = *find_lane(types == PairTypes::f64 ? fuzz::kExactDoubles : fuzz::kExactLane);
  std::vector<const Lane*> timed{&exact};
  for (const Lane& lane : lanes) timed.push_back(&lane);
  const std::vector<std::optional<analysis::Cost>> costs =
      analysis::costs_of(timed, analysis::first_pairs(spec.others, kTimed), kPasses);
  for (std::size_t c = 0; c < candidates.size(); ++c) candidates[c].cost = costs[c + 1].value();
  const strata::SceneSources last = drawn({pairs, 3, {}, types, scene});
  // Candidates were selected by their errors on earlier pairs, so fresh pairs must confirm the cheapest one.
  while (const Candidate* best = reports::cheapest_sufficient(candidates)) {
    const std::ptrdiff_t place = best - candidates.data();
    Candidate& chosen = candidates.begin()[place];
    const Lane& lane = lanes.begin()[place];
    chosen.errors = analysis::host_sweep([&](const std::string&) { return lane.decide; })(
        std::vector<std::string>{lane.policy}, last.sources)[0];
    chosen.bound = analysis::upper_bound(chosen.errors.wrong(), chosen.errors.pairs);
    if (chosen.bound <= rate) break;
    chosen.result = analysis::TuneResult::not_confirmed;
  }
  std::vector<std::string> sentences = reports::sufficient_sentences(rate, candidates, exact.id, costs[0].value());
  sentences.push_back(reports::costs_sentence(analysis::Calls::of_blocks,
                                              fmt::format("{} of the scene's pairs", reports::grouped(kTimed)),
                                              fuzz::machine_name(), kPasses));
  print_wrapped(sentences);
  fmt::print("{}", left_out_text(last.left_out));
}

}  // namespace graze::cli
