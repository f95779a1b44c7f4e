// SPDX-License-Identifier: Apache-2.0
// `graze invariants`: counts how often each lane's verdict changes although the correct answer stays the same.
#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/simplify/simplicity.h"
#include "core/text.h"
#include "fuzz/files.h"
#include "reports/invariants.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

struct InvariantsOptions : DrawOptions {
  InvariantsOptions() : DrawOptions{20'000} {}
  LaneOptions lanes;
  int threads = 0;
  std::string out = "invariants";
};

int invariants(const InvariantsOptions& options) {
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes);
  if (options.coordinates != PairTypes::f32) take_doubles(under_test);
  analysis::InvariantSpec spec;
  spec.lanes = under_test.lanes;
  spec.on_host = under_test.on_host;
  strata::SceneSources all = drawn(options);
  spec.sources = std::move(all.sources);
  spec.threads = options.threads;
  spec.simpler = is_simpler;
  const ResultFolder folder(options.out, "invariants.json");
  const analysis::Invariants found = analysis::invariants(spec);

  const fs::path& out = folder.path;
  fs::create_directories(out / "cases");
  const reports::Screen screen = output_screen();
  fmt::print("{}", reports::invariants_table(spec, found, screen));
  print_wrapped(reports::invariants_sentences(spec, found));
  fmt::print("{}", left_out_text(all.left_out));
  nlohmann::ordered_json json = {{"pairs", options.pairs}, {"seed", options.seed}};
  if (!options.scene.empty()) json["scene"] = options.scene;
  fuzz::add_left_out(json, under_test);
  json.update(reports::invariants_json(spec, found));
  const std::map<std::string, std::string> cases = reports::invariants_cases(spec, found);
  std::vector<Result> results = {{"invariants.json", json.dump(1) + "\n"}};
  for (const auto& [file, text] : cases) results.push_back({"cases/" + file, text});
  write_results(out, results);
  for (const analysis::InvariantInfo& invariant : analysis::kInvariants) {
    if (const std::string file = std::string(invariant.id) + ".pairs"; !cases.contains(file))
      remove_result(out / "cases" / file, kPairs);
  }
  fmt::print("Wrote {0}/invariants.json{1}\n", printable(out.string()),
             cases.empty() ? "" : fmt::format(", {}/cases/", printable(out.string())));
  if (cases.empty()) return 0;
  const std::string first = (out / "cases" / cases.begin()->first).string();
  fmt::print("Next: graze explain {}\n", path_word(first));
  return 0;
}

}  // namespace

void add_invariants(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "invariants",
      "Count how often a verdict changes although the answer cannot: triangles swapped, mirrored, scaled, …");
  command->footer("Example: graze invariants --lanes '*/f32/cpu' --strata 'near_*' --pairs 2000");
  const auto options = std::make_shared<InvariantsOptions>();
  add_lane_options(*command, options->lanes, Executors::twins);
  add_draw_options(*command, *options);
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole,
            "Number of pairs in total, shared evenly by the strata; each is decided in about 70 forms");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of the pairs");
  add_threads_option(*command, options->threads);
  add_valued(*command, "--out", options->out, "DIR", "Folder for invariants.json and the simplest cases")
      ->capture_default_str();
  run_drawing(*command, options, status, invariants);
}

}  // namespace graze::cli
