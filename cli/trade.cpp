// SPDX-License-Identifier: Apache-2.0
// `graze trade`: errors against nanoseconds, and how far from ordinary pairs each lane stays right.
#include <fmt/format.h>

#include <map>

#include "analysis/trade.h"
#include "cli/commands.h"
#include "cli/screen.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/files.h"
#include "reports/trade.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPairsInCache = 256, kPairsFromMemory = std::size_t{1} << 19;  // 18 kB, 38 MB

struct TradeOptions {
  LaneOptions lanes;
  std::vector<std::string> strata;
  std::uint64_t pairs = 200'000, seed = 1;
  std::string scene, out = "trade";
};

int trade(TradeOptions options) {
  if (options.lanes.globs.empty())
    options.lanes.globs = {"*/cpu", "exact/f32/cpu", "moller_1997/*/cpu/paper", "guigue_devillers_2003/*/cpu/filtered"};
  const fuzz::LanesUnderTest under_test = lanes_under_test(options.lanes);
  std::map<std::string, DecideBlock> blocks;
  std::vector<std::string> ids;
  for (const Lane* lane : under_test.lanes) {
    if (!lane->decide || lane->foreign) continue;  // what a twin or a process takes is not what the code takes
    ids.push_back(lane->id);
    blocks[lane->id] = lane->decide;
  }
  if (ids.empty()) throw std::runtime_error("expected a lane of this processor, found only others");
  blocks[""] = find_lane("exact/f32/cpu")->decide;
  const analysis::Sweep sweep = analysis::host_sweep([&](const std::string& id) { return blocks.at(id); });
  const strata::SceneSources all = drawn(options.scene, options.seed, options.pairs, options.strata);
  const std::vector<strata::PairSource>& sources = all.sources;

  const std::vector<analysis::PolicyErrors> errors = sweep(ids, sources);
  std::vector<DecideBlock> timed;
  for (const std::string& id : ids) timed.push_back(blocks.at(id));
  const auto in_cache = analysis::costs_of(timed, analysis::first_pairs(sources, kPairsInCache), 201);
  const auto from_memory = analysis::costs_of(timed, analysis::first_pairs(sources, kPairsFromMemory), 3);
  std::vector<analysis::Offer> offers;
  for (std::size_t l = 0; l < ids.size(); ++l)
    offers.push_back({ids[l], errors[l], in_cache[l], from_memory[l], false});
  analysis::mark_dominated(offers);

  std::vector<analysis::ExtremeCurve> curves;
  const auto some =
      drawn(options.scene, options.seed, std::max<std::uint64_t>(options.pairs / 50, 1000), options.strata).sources;
  for (const analysis::Extreme extreme : analysis::kExtremes) {
    const std::size_t first = curves.size();
    for (const std::string& id : ids) curves.push_back({id, extreme, {}});
    for (const int k : analysis::exponents(extreme)) {
      const auto found = sweep(ids, analysis::made_extreme(some, extreme, k));
      for (std::size_t l = 0; l < ids.size(); ++l) curves[first + l].points.emplace_back(k, found[l]);
    }
  }

  const fs::path out = options.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw std::runtime_error(out.string() + ": expected a folder, found: " + error.message());
  const reports::Screen screen = output_screen();
  fmt::print("{}", reports::trade_table(offers, screen));
  for (const std::string& sentence : reports::extreme_sentences(curves))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  fmt::print("{}", left_out_text(all.left_out));
  nlohmann::ordered_json json = {{"machine", fuzz::machine_name()}, {"pairs", options.pairs}, {"seed", options.seed}};
  json.update(reports::trade_json(offers, curves));
  fuzz::write_whole(out / "trade.json", json.dump(1) + "\n");
  fuzz::write_whole(out / "front.svg", reports::trade_figure(offers));
  for (const analysis::Extreme extreme : analysis::kExtremes)
    fuzz::write_whole(out / (std::string(name(extreme)) + ".svg"), reports::extreme_figure(curves, extreme));
  fmt::print("Wrote {}/{{trade.json,front.svg,scale.svg,offset.svg,flatness.svg,aspect.svg}}\n", out.string());
  return 0;
}

}  // namespace

void add_trade(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "trade", "Measure errors against nanoseconds a pair, and how far from ordinary pairs each lane stays right");
  command->footer("Example: graze trade --strata 'near_*' --pairs 20k");
  const auto options = std::make_shared<TradeOptions>();
  add_lane_options(*command, options->lanes, Executors::twins);
  add_globs(*command, "--strata", options->strata, "Only strata that match a pattern");
  add_scene_option(*command, options->scene);
  command->add_option("--pairs", options->pairs, "Pairs to count errors on")
      ->transform(whole_number(1000, kMostWhole))
      ->capture_default_str()
      ->option_text("N");
  command->add_option("--seed", options->seed, "Seed of the pairs")
      ->transform(whole_number(0, kMostWhole))
      ->capture_default_str()
      ->option_text("N");
  command->add_option("--out", options->out, "Folder for trade.json and the pictures")
      ->check(not_empty())
      ->capture_default_str()
      ->option_text("DIR");
  command->callback([options, &status] { status = trade(*options); });
}

}  // namespace graze::cli
