// SPDX-License-Identifier: Apache-2.0
// docs/league.md takes hours to generate, so the tests only check that it has the form of the generator's output.
#include "reports/league.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "fuzz/files.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

std::string first_match(const std::string& text, const char* pattern) {
  std::smatch found;
  return std::regex_search(text, found, std::regex(pattern)) ? found[1].str() : "";
}

// The nonempty lines, with # for each number.
std::vector<std::string> form_of(const std::string& page) {
  std::vector<std::string> lines;
  std::istringstream in(std::regex_replace(page, std::regex("[0-9][0-9,]*"), "#"));
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

// The page of a league without lanes: its words and table headers.
std::string empty_page(const std::string& command, const std::string& machine, const std::string& date) {
  Json groups;
  for (const std::string_view group : fuzz::kLeagueGroups) groups[std::string(group)] = 1;
  const Json none = Json::array();
  Json league = {{"seed", 1},
                 {"pairs", 1},
                 {"groups", groups},
                 {"subjects", none},
                 {"rows", none},
                 {"failures", none},
                 {"failures_not_repeated", 0},
                 {"timings", {{"machine", machine}, {"date", date}}}};
  if (command.find("--coordinates f64") != command.npos) league["coordinates"] = "f64";
  return league_page(league, command);
}

// The first line of the generator's form that is missing at its position in the page, or "".
std::string first_line_missing(const std::string& page) {
  const std::string measured = first_match(page, "own process; ([^\n]*), [0-9]{4}-[0-9]{2}-[0-9]{2}\\.\n");
  const std::vector<std::string> form = form_of(empty_page(first_match(page, "Made by `([^`]*)`"), measured,
                                                           first_match(page, "([0-9]{4}-[0-9]{2}-[0-9]{2})\\.\n")));
  const std::vector<std::string> lines = form_of(page);
  auto at = lines.begin();
  for (const std::string& line : form) {
    at = std::find(at, lines.end(), line);
    if (at == lines.end()) return line;
    ++at;
  }
  return "";
}

void expect_form_of_its_generator(const std::string& file) {
  const std::string page = fuzz::read_whole(GRAZE_SOURCE_DIR + file);
  EXPECT_EQ(first_line_missing(page), "") << file << " is older than reports/league.cpp: run scripts/league";
  const std::vector<std::string> lines = form_of(page);
  auto row = std::find_if(lines.begin(), lines.end(), [](const auto& line) { return line.starts_with("| lane |"); });
  ASSERT_NE(row, lines.end());
  const auto cells = [](const std::string& line) { return std::count(line.begin(), line.end(), '|'); };
  const auto columns = cells(*row);
  int rows = 0;
  for (; row != lines.end() && row->starts_with("|"); ++row, ++rows) EXPECT_EQ(cells(*row), columns) << *row;
  EXPECT_GE(rows, 20);
}

TEST(LeaguePage, InDocsHasTheFormOfItsGenerator) {
  expect_form_of_its_generator("/docs/league.md");
  expect_form_of_its_generator("/docs/league_double.md");
}

TEST(LeaguePage, OfAnOlderGeneratorIsFound) {
  const std::string page = fuzz::read_whole(GRAZE_SOURCE_DIR "/docs/league.md");
  const auto without = [&](const std::string& part) {
    std::string older = page;
    const std::size_t at = older.find(part);
    return at == older.npos ? "" : first_line_missing(older.erase(at, part.size()));
  };
  EXPECT_TRUE(without(" | invariants").starts_with("| lane |"));
  EXPECT_TRUE(without("- **invariants**: ").starts_with("- **invariants**: "));
  EXPECT_EQ(without("## Shares\n"), "## Shares");
}

}  // namespace
}  // namespace graze::reports
