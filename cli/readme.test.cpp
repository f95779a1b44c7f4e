// SPDX-License-Identifier: Apache-2.0
// The tour in README.md is real: each `$ command` of its console blocks is run, and must print what stands under it.
#include <gtest/gtest.h>

#include <vector>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

struct Step {
  std::string command;
  std::vector<std::string> expected;  // lines; "…" stands for any number of lines
};

std::vector<Step> steps_of(const std::filesystem::path& file) {
  std::vector<Step> steps;
  std::ifstream in(file);
  std::string line;
  bool in_console = false;
  while (std::getline(in, line)) {
    if (line.starts_with("```")) {
      in_console = line == "```console";
    } else if (in_console && line.starts_with("$ ")) {
      steps.push_back({line.substr(2), {}});
    } else if (in_console && !steps.empty()) {
      steps.back().expected.push_back(line);
    }
  }
  return steps;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool matches(const std::vector<std::string>& expected, std::size_t e, const std::vector<std::string>& found,
             std::size_t f) {
  if (e == expected.size()) return f == found.size();
  if (expected[e] == "…")
    return matches(expected, e + 1, found, f) || (f < found.size() && matches(expected, e, found, f + 1));
  return f < found.size() && expected[e] == found[f] && matches(expected, e + 1, found, f + 1);
}

TEST(Readme, EveryCommandPrintsWhatItSays) {
  const std::vector<Step> steps = steps_of(std::string(GRAZE_SOURCE_DIR) + "/README.md");
  ASSERT_GE(steps.size(), 5u);
  const Shell shell("readme");
  for (const Step& step : steps) {
    const Ran ran = shell(step.command);
    EXPECT_TRUE(matches(step.expected, 0, lines_of(ran.out + ran.err), 0)) << "$ " << step.command << '\n'
                                                                           << ran.out << ran.err;
  }
}

}  // namespace
}  // namespace graze::cli
