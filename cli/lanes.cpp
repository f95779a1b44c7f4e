// SPDX-License-Identifier: Apache-2.0
// `graze lanes` and `graze strata`: the two tables, as the code has them.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "strata/strata.h"

namespace graze::cli {
namespace {

void print_lanes(bool json) {
  std::string why_no_device;
  const auto device = cuda::open_device(why_no_device);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  const AlgorithmInfo* last = nullptr;
  for (const Lane& lane : lanes()) {
    const std::string here = fuzz::status(lane, device.get(), why_no_device);
    if (json) {
      rows.push_back({{"lane", lane.id},
                      {"status", here},
                      {"algorithm", lane.info->id},
                      {"scalar", name(lane.scalar)},
                      {"target", name(lane.variant)},
                      {"paper", lane.info->paper},
                      {"coplanar", lane.info->coplanar},
                      {"degenerate", lane.info->degenerate},
                      {"order", lane.info->order}});
      continue;
    }
    if (lane.info != last) {
      fmt::print("{}{}: {}\n  coplanar: {}\n  degenerate: {}\n  order: {}\n", last ? "\n" : "", lane.info->id,
                 lane.info->paper, lane.info->coplanar, lane.info->degenerate, lane.info->order);
      last = lane.info;
    }
    fmt::print("  {:<36} {}\n", lane.id, here);
  }
  fmt::print("{}\n", json ? rows.dump(1) : "\nNext: graze fuzz --lanes '*/f32/cpu'");
}

}  // namespace

void add_lanes(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("lanes", "List the lanes: every way to decide a pair, and whether it runs here");
  command->footer("Example: graze lanes --json | jq -r '.[].lane'");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "One JSON array");
  command->callback([json] { print_lanes(*json); });
}

void add_strata(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand("strata", "List the strata: the named generators of pairs");
  command->footer("Example: graze strata");
  command->callback([] {
    for (const strata::StratumInfo& row : strata::kStrata) fmt::print("{:<20} {}\n", row.id, row.what);
    fmt::print("\nNext: graze fuzz --strata 'near_*'\n");
  });
}

}  // namespace graze::cli
