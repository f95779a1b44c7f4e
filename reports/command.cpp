// SPDX-License-Identifier: Apache-2.0
// The command that runs a campaign, with the ids of its lanes and strata.
#include <fmt/format.h>

#include <algorithm>

#include "core/lanes/lanes.h"
#include "reports/report.h"
#include "strata/strata.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// Quotes the word for a shell.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

// The option that selects the lanes that ran: by the requested patterns if some lanes were left out, else by name.
// Empty if all lanes of this build ran.
std::string lane_option(const Json& spec, const std::vector<std::string>& ids) {
  if (spec.contains("lanes_left_out"))
    return fmt::format(" --lanes '{}'",
                       fmt::join(spec["lanes_left_out"].at("patterns").get<std::vector<std::string>>(), ","));
  return ids.size() == lanes().size() ? "" : fmt::format(" --lanes '{}'", fmt::join(ids, ","));
}

// A hunt's command names the strata that it draws from, not its single source.
std::string hunt_command(const Json& spec, const std::vector<std::string>& ids) {
  const std::vector<std::string> strata = spec.at("hunt").at("strata");
  std::string command = fmt::format("graze hunt --runs {} --seed {}", spec.at("pairs").dump(), spec.at("seed").dump());
  if (spec.contains("scene")) command += " --scene " + quoted(spec.at("scene").at("file").get<std::string>());
  if (spec.contains("scene") || strata.size() != strata::kStrataCount)
    command += fmt::format(" --strata {}", fmt::join(strata, ","));
  command += lane_option(spec, ids);
  return command + " --out hunt";
}

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, ",")); }

}  // namespace

std::string campaign_command(const Json& summary) {
  const Json& spec = summary.at("spec");
  std::vector<std::string> strata = spec.at("strata");
  const auto ids = spec.at("lanes").get<std::vector<std::string>>();
  if (spec.contains("hunt")) return hunt_command(spec, ids);
  std::string command = "graze fuzz";
  std::uint64_t pairs = spec.at("pairs");
  if (spec.contains("mesh")) {
    command += " --mesh";
    for (const Json& file : spec.at("mesh").at("files")) command += " " + quoted(file.get<std::string>());
    pairs -= summary.at("strata").at("mesh").at("pairs").get<std::uint64_t>();
    std::erase(strata, "mesh");
  }
  if (spec.contains("scene")) {
    command += " --scene " + quoted(spec.at("scene").at("file").get<std::string>());
    pairs = spec.at("scene").at("pairs");
  }
  if (!strata.empty()) command += fmt::format(" --pairs {} --seed {}", pairs, spec.at("seed").dump());
  const bool all_strata = strata.size() == strata::kStrataCount && !spec.contains("mesh");
  if (!strata.empty() && !all_strata) command += fmt::format(" --strata {}", joined(strata));
  command += lane_option(spec, ids);
  const Json executors = summary.at("build").value("executors", Json::object());
  const auto any = [&](std::string_view start) {
    return std::any_of(executors.begin(), executors.end(),
                       [&](const Json& evidence) { return evidence.get<std::string>().starts_with(start); });
  };
  const char* executor = any("device and ") ? " --executor both" : any("twin") ? " --executor twin" : "";
  return command + executor + " --out campaign";
}

}  // namespace graze::reports
