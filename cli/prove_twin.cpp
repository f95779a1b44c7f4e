// SPDX-License-Identifier: Apache-2.0
// `graze prove-twin`: on a device, verifies that the twins give its verdicts, and writes the record.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cuda/twin/prove.h"
#include "fuzz/campaign/result_files.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

int prove(const cuda::ProofOptions& options, const std::string& out) {
  const cuda::ProofRecord record = cuda::prove_twin(options);
  fuzz::write_whole(out, to_json(record).dump(1) + "\n");
  fmt::print("{:<36}{:>16}{:>13}{:>16}{:>13}\n", "lane", "explicit PTX", "differences", "twin", "differences");
  for (const cuda::LaneProof& lane : record.lanes) {
    fmt::print("{:<36}{:>16}{:>13}{:>16}{:>13}\n", lane.lane, reports::grouped(lane.pairs()),
               reports::grouped(lane.differences()), reports::grouped(lane.twin_pairs()),
               reports::grouped(lane.twin_differences()));
  }
  fmt::print("\n{}, driver {}, nvcc {}: {} in {:.0f} s. Wrote {}\n", record.device, record.driver, record.toolkit,
             record.verified() ? "verified" : "NOT verified", record.seconds, out);
  return record.verified() ? 0 : 1;
}

}  // namespace

void add_prove_twin(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "prove-twin",
      "On a GPU: compare each CUDA lane with its explicit PTX and its twin, bit for bit; exit 1 on any difference");
  command->footer("Example: graze prove-twin --pairs 10000000000 --out proof.json");
  auto options = std::make_shared<cuda::ProofOptions>();
  auto out = std::make_shared<std::string>("proof.json");
  command->add_option("--pairs", options->pairs, "Pairs a lane, all strata together")
      ->transform(whole_number(1, kMostWhole))
      ->capture_default_str();
  command->add_option("--twin-pairs", options->twin_pairs, "Of them, by the twin too")
      ->transform(whole_number(1, kMostWhole))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of all strata")
      ->transform(whole_number(0, kMostWhole))
      ->capture_default_str();
  add_globs(*command, "--lanes", options->lanes, "Only lanes that match a pattern");
  command->add_flag("--wrong-rule", options->wrong_rule, "Contract the wrong product first: the proof must then fail");
  command->add_option("--out", *out, "File of the record")->check(not_empty())->capture_default_str();
  command->callback([options, out, &status] {
    options->progress = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
    status = prove(*options, *out);
  });
}

}  // namespace graze::cli
