// SPDX-License-Identifier: Apache-2.0
// A campaign as the command that runs it: lanes and strata by the fewest patterns.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/lanes.h"
#include "reports/report.h"
#include "strata/strata.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// As a shell reads it back.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, ",")); }

// Patterns that match these lanes of the table and no others, none of which can be spared: at each step that which
// matches most of those left.
std::vector<std::string> lane_patterns(const std::vector<std::string>& ids) {
  const std::set<std::string> wanted(ids.begin(), ids.end());
  std::set<std::string> candidates, left = wanted;
  for (const std::string& id : ids) {
    const std::size_t first = id.find('/'), last = id.rfind('/');
    const std::string algorithm = id.substr(0, first), scalar = id.substr(first, last - first),
                      target = id.substr(last);
    for (const std::string& a : {algorithm, std::string("*")}) {
      for (const std::string& t : {target, std::string("/cuda-*"), std::string("/*")}) {
        candidates.insert(a + scalar + t);
        candidates.insert(a + (t == "/*" ? t : "/*" + t));
      }
    }
    candidates.insert(id);
    candidates.insert("*" + target);
  }
  std::vector<std::string> chosen;
  while (!left.empty()) {
    std::string best;
    std::ptrdiff_t most = 0;
    for (const std::string& pattern : candidates) {
      const bool fits = std::all_of(lanes().begin(), lanes().end(), [&](const Lane& lane) {
        return wanted.contains(lane.id) || !matches_any({pattern}, lane.id);
      });
      const auto matched =
          std::count_if(left.begin(), left.end(), [&](const std::string& id) { return matches_any({pattern}, id); });
      if (!fits || matched < most || (matched == most && !(pattern.size() < best.size()))) continue;
      most = matched;
      best = pattern;
    }
    std::erase_if(left, [&](const std::string& id) { return matches_any({best}, id); });
    chosen.push_back(best);
  }
  // What came first may be covered by what came later.
  for (std::size_t i = 0; i < chosen.size();) {
    std::vector<std::string> others = chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const bool spare = !others.empty() && std::all_of(ids.begin(), ids.end(),
                                                      [&](const std::string& id) { return matches_any(others, id); });
    if (spare) {
      chosen = others;
    } else {
      ++i;
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

std::string campaign_command(const Json& summary) {
  const Json& spec = summary.at("spec");
  std::vector<std::string> strata = spec.at("strata");
  const auto ids = spec.at("lanes").get<std::vector<std::string>>();
  std::string command = "graze fuzz";
  std::uint64_t pairs = spec.at("pairs");
  if (spec.contains("mesh")) {
    command += " --mesh";
    for (const Json& file : spec["mesh"]["files"]) command += " " + quoted(file.get<std::string>());
    pairs -= summary["strata"]["mesh"]["pairs"].get<std::uint64_t>();
    std::erase(strata, "mesh");
  }
  if (!strata.empty()) command += fmt::format(" --pairs {} --seed {}", pairs, spec.at("seed").dump());
  const bool all_strata = strata.size() == strata::kStrataCount && !spec.contains("mesh");
  if (!strata.empty() && !all_strata) command += fmt::format(" --strata {}", joined(strata));
  if (ids.size() != lanes().size()) command += fmt::format(" --lanes '{}'", joined(lane_patterns(ids)));
  const Json executors = summary.at("build").value("executors", Json::object());
  const auto any = [&](std::string_view start) {
    return std::any_of(executors.begin(), executors.end(),
                       [&](const Json& evidence) { return evidence.get<std::string>().starts_with(start); });
  };
  const char* executor = any("device and ") ? " --executor both" : any("twin") ? " --executor twin" : "";
  return command + executor + " --out campaign";
}

}  // namespace graze::reports
