// SPDX-License-Identifier: Apache-2.0
// `graze lanes`: prints the table of lanes from the code.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cli/commands.h"
#include "cli/screen.h"

namespace graze::cli {
namespace {

void print_lanes(bool json, const std::vector<std::string>& globs) {
  std::string why_no_device;
  const auto device = cuda::open_device(why_no_device);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  constexpr std::string_view kTwin = "available (twin, ";
  std::set<std::string> twins;
  const AlgorithmInfo* last = nullptr;
  const reports::Screen screen = output_screen();
  fuzz::expect_each_matches(globs);
  for (const Lane& lane : lanes()) {
    if (!matches_any(globs, lane.id)) continue;
    const std::string here = fuzz::status(lane, device.get(), why_no_device);
    if (json) {
      rows.push_back({{"lane", lane.id},
                      {"status", here},
                      {"algorithm", lane.info->id},
                      {"scalar", name(lane.scalar)},
                      {"target", lane.variant_name()},
                      {"paper", lane.info->paper},
                      {"coplanar", lane.info->coplanar},
                      {"degenerate", lane.info->degenerate},
                      {"order", lane.info->order}});
      continue;
    }
    if (lane.info != last) {
      const auto line = [&](std::string_view what, std::string_view text, int indent) {
        fmt::print("{}", reports::wrapped(fmt::format("{}: {}", what, text), screen.columns, indent, indent + 2));
      };
      if (last) fmt::print("\n");
      line(lane.info->id, lane.info->paper, 0);
      line("coplanar", lane.info->coplanar, 2);
      line("degenerate", lane.info->degenerate, 2);
      line("order", lane.info->order, 2);
      last = lane.info;
    }
    // The evidence for twins is long and mostly the same, so it is printed once at the end.
    const bool twin = here.starts_with(kTwin);
    if (twin) twins.insert(here.substr(kTwin.size(), here.size() - kTwin.size() - 1));
    if (here == "available (twin)") twins.insert("not verified");
    const std::string shown = twin ? "available (twin)" : here;
    fmt::print("{}", reports::wrapped(fmt::format("{:<36} {}", lane.id, shown), screen.columns, 2, 6));
  }
  if (json) fmt::print("{}\n", rows.dump(1));
  if (!twins.empty()) {
    fmt::print("\n");
    print_wrapped(
        {fmt::format("CUDA lanes run by their twins, on the CPU, because there is no device ({}). Twins are: {}.",
                     why_no_device, fmt::join(twins, "; or "))});
  }
  if (!json) fmt::print("\nNext: graze fuzz --lanes '*/f32/cpu'\n");
}

}  // namespace

void add_lanes(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("lanes", "List the lanes: every algorithm, precision and build, and whether it runs here");
  command->footer("Example: graze lanes --json | jq -r '.[].lane'");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print one JSON array");
  auto lanes = std::make_shared<LaneOptions>();
  add_lane_options(*command, *lanes);
  command->get_option("--lanes")->description("Patterns of the lanes to list");
  command->callback([json, lanes] {
    open_subjects(*lanes);
    std::vector<std::string> ids;
    for (const Lane& lane : graze::lanes()) {
      if (matches_any(lanes->globs, lane.id)) ids.push_back(lane.id);
    }
    expect_own_code_among(*lanes, ids, "--lanes");
    print_lanes(*json, lanes->globs);
  });
}

}  // namespace graze::cli
