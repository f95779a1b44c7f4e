// SPDX-License-Identifier: Apache-2.0
// `graze prove-twin`: verifies on a device that the twins give the device's verdicts, and writes the record.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/results.h"
#include "core/error.h"
#include "core/text.h"
#include "cuda/twin/prove.h"
#include "fuzz/campaign/result_files.h"
#include "reports/terminal.h"
#include "subjects/subjects.h"

namespace graze::cli {
namespace {

// Proves the twins of the subjects if there are any; otherwise those of the published algorithms.
cuda::ProofRecord record_of(const cuda::ProofOptions& options, const LaneOptions& lanes, std::string& out) {
  if (!lanes.toolchains.empty())
    throw UsageError("--toolchains: only CUDA lanes have twins, and no other toolchain builds them; leave it out");
  open_subjects(lanes);
  std::vector<cuda::NamedBuild> builds = subjects::cuda_builds();
  std::erase_if(builds, [&](const cuda::NamedBuild& named) {
    return named.build->twin.empty() || !matches_any(options.lanes, named.lane) ||
           (options.of_doubles && named.build->scalar != Scalar::f64);
  });
  if (lanes.subjects.empty()) return cuda::prove_twin(options);
  const std::string of = options.of_doubles ? "of a function of doubles " : "";
  if (builds.empty()) throw UsageError("none of the subjects is a CUDA source " + of + "with a twin");
  for (const std::string& name : subject_names(lanes)) {
    if (std::none_of(builds.begin(), builds.end(), [&](auto& named) { return named.lane.starts_with(name + '/'); }))
      throw UsageError(fmt::format("--subject {} is not a CUDA source {}with a twin that --lanes selects", name, of));
  }
  if (out.empty())
    out = subjects::proof_file(subjects::opened(parse_lane_name(builds[0].lane)->subject)->file).string();
  return cuda::prove_subjects(builds, options);
}

int prove(const cuda::ProofOptions& options, const LaneOptions& lanes, std::string out) {
  const cuda::ProofRecord record = record_of(options, lanes, out);
  if (out.empty()) out = "proof.json";
  write_result(out, to_json(record).dump(1) + "\n", fuzz::NamedBy::user);
  fmt::print("{:<36}{:>16}{:>13}{:>16}{:>13}\n", "lane", "explicit PTX", "differences", "twin", "differences");
  for (const cuda::LaneProof& lane : record.lanes) {
    fmt::print("{:<36}{:>16}{:>13}{:>16}{:>13}\n", lane.lane, reports::grouped(lane.pairs()),
               reports::grouped(lane.differences()), reports::grouped(lane.twin_pairs()),
               reports::grouped(lane.twin_differences()));
  }
  fmt::print("\n{}, driver {}, nvcc {}: {} in {:.0f} s. Wrote {}\n", record.device, record.driver, record.toolkit,
             record.verified() ? "verified" : "NOT verified", record.seconds, printable(out));
  return record.verified() ? 0 : 1;
}

}  // namespace

void add_prove_twin(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "prove-twin",
      "Compare each CUDA lane on the GPU with its explicit PTX and its twin, bit for bit; exit with 1 if any differ");
  command->footer("Example: graze prove-twin --pairs 1e10 --out proof.json");
  auto options = std::make_shared<cuda::ProofOptions>();
  auto out = std::make_shared<std::string>();
  auto lanes = std::make_shared<LaneOptions>();
  auto coordinates = std::make_shared<PairTypes>(PairTypes::f32);
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole, "Number of pairs per lane, divided among all strata");
  add_count(*command, "--twin-pairs", options->twin_pairs, 1, kMostWhole,
            "Number of these pairs that the twin replays as well");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of all strata");
  add_coordinates_option(*command, *coordinates);
  add_lane_options(*command, *lanes, Executors::twins);
  command->add_flag("--wrong-rule", options->wrong_rule,
                    "Use a wrong contraction rule on purpose; the comparison must then fail");
  add_valued(*command, "--out", *out, "FILE",
             "File for the record (default: proof.json; for a subject FILE.cu.proof.json, where graze looks for it)");
  command->callback([options, lanes, coordinates, out, &status] {
    if (*coordinates == PairTypes::both) throw UsageError("--coordinates both: a record has one type; name f32 or f64");
    options->of_doubles = *coordinates == PairTypes::f64;
    options->lanes = lanes->globs;
    options->progress = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
    status = prove(*options, *lanes, *out);
  });
}

}  // namespace graze::cli
