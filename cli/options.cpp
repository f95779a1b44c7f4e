// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>
#include <set>

#include "cli/commands.h"
#include "core/text.h"

namespace graze::cli {

CLI::Option* add_globs(CLI::App& command, const char* name, std::vector<std::string>& globs, const char* description) {
  return command.add_option(name, globs, description)->delimiter(',')->allow_extra_args(false)->option_text("GLOB,…");
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](std::string& text) -> std::string {
    const std::optional<std::uint64_t> value = parse_whole(text);
    if (value && *value >= least && *value <= most) return {};
    return fmt::format("expected a whole number from {} to {}, found '{}'", least, most, text);
  };
  return CLI::Validator(check, "");
}

CLI::Validator not_empty() {
  return CLI::Validator([](std::string& text) { return text.empty() ? "expected a name, found ''" : std::string(); },
                        "");
}

void add_lane_options(CLI::App& command, LaneOptions& options) {
  static const std::map<std::string, fuzz::Executor> names{{"auto", fuzz::Executor::automatic},
                                                           {"device", fuzz::Executor::device},
                                                           {"twin", fuzz::Executor::twin},
                                                           {"both", fuzz::Executor::both}};
  add_globs(command, "--lanes", options.globs, "Only lanes that match a pattern");
  command
      .add_option(
          "--executor", options.executor,
          "What runs the CUDA lanes: auto (the device where there is one, else its twin), device, twin, or both "
          "(compared)")
      ->transform(CLI::CheckedTransformer(names))
      ->option_text("auto|device|twin|both");
}

std::vector<Verdict> decide(const fuzz::LanesUnderTest& under_test, const Pair& pair) {
  std::vector<const Lane*> apart;
  std::vector<Verdict> verdicts = decide(under_test, pair, apart);
  for (const Lane* lane : apart) fmt::print(stderr, "graze: {}: device and twin differ\n", lane->id);
  return verdicts;
}

std::string cuda_evidence(const fuzz::LanesUnderTest& under_test) {
  std::set<std::string> kinds;
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
    if (under_test.lanes[l]->is_cuda()) kinds.insert(under_test.evidence(l));
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

}  // namespace graze::cli
