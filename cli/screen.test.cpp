// SPDX-License-Identifier: Apache-2.0
// The output on a terminal, simulated by a pseudo-terminal: it fits, and it has colour if allowed.
#include <fcntl.h>
#include <pty.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/progress.h"
#include "cli/run_graze.h"

namespace graze::cli {
namespace {

constexpr const char* kColour = "\033[1m";

// Runs a command on a pseudo-terminal with `columns` columns.   Returns: its output without carriage returns at line
// ends.
std::string on_terminal(const Shell& shell, const std::string& command, unsigned short columns,
                        const std::string& environment = "unset NO_COLOR COLUMNS; export TERM=xterm") {
  const winsize size{50, columns, 0, 0};
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    const std::string line =
        environment + "; cd '" + shell.folder.string() + "'; PATH='" + GRAZE_BINARY_DIR + "':$PATH; " + command;
    execl("/bin/bash", "bash", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  EXPECT_GT(child, 0);
  std::string text;
  char buffer[4096];
  for (ssize_t got; (got = read(terminal, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<size_t>(got));
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << command << '\n' << text;
  for (std::size_t at; (at = text.find("\r\n")) != text.npos;) text.erase(at, 1);
  return text;
}

std::string without_colour(std::string text) {
  for (std::size_t at; (at = text.find("\033[")) != text.npos;) text.erase(at, text.find_first_of("mK", at) - at + 1);
  return text;
}

// Returns the width of the widest line; a carriage return starts a new line.
int widest(const std::string& text) {
  int most = 0;
  std::string line;
  std::istringstream in(without_colour(text));
  while (std::getline(in, line)) {
    std::istringstream parts(line);
    for (std::string part; std::getline(parts, part, '\r');) most = std::max(most, reports::width_of(part));
  }
  return most;
}

class ScreenTest : public CommandTest {};

class TerminalTest : public CommandTest {
 protected:
  void SetUp() override {
    int terminal = -1, shown = -1;
    if (openpty(&terminal, &shown, nullptr, nullptr, nullptr) != 0)
      GTEST_SKIP() << "no pseudo-terminal: " << std::strerror(errno);
    close(terminal);
    close(shown);
  }
};

TEST_F(TerminalTest, ColourIsForTerminalsThatWantIt) {
  const std::string explain = "graze explain exact_contact:1:10 --lanes '*/f32/cpu'";
  const std::string piped = shell(explain).out;
  EXPECT_EQ(piped.find('\033'), std::string::npos) << piped;
  const std::string shown = on_terminal(shell, explain, 80);
  EXPECT_TRUE(has(shown, {kColour, "\033[31mdisjoint !\033[0m"}));
  EXPECT_EQ(without_colour(shown), piped);  // colour adds no information
  for (const char* without : {"export TERM=xterm NO_COLOR=1", "unset NO_COLOR; export TERM=dumb"})
    EXPECT_EQ(on_terminal(shell, explain, 80, without), piped) << without;
  EXPECT_TRUE(has(on_terminal(shell, explain, 80, "export TERM=xterm NO_COLOR="), {kColour}));
  EXPECT_EQ(on_terminal(shell, explain + " | cat", 80), piped);
}

TEST_F(TerminalTest, ErrorsAreColouredWhereTheyAreRead) {
  EXPECT_TRUE(has(on_terminal(shell, "graze check missing > /dev/null || true", 80), {kColour}));
  EXPECT_EQ(on_terminal(shell, "graze check missing 2> error || cat error", 80).find('\033'), std::string::npos);
  EXPECT_EQ(on_terminal(shell, "graze check missing || true", 80, "export NO_COLOR=1").find('\033'), std::string::npos);
}

TEST_F(TerminalTest, WhatIsPrintedFitsEightyColumnsAndUsesMore) {
  ASSERT_EQ(shell("graze fuzz --pairs 3000 --executor twin --out c > /dev/null && "
                  "graze minimize lattice:1:1 --lanes 'projected*/f32/cpu' --out m.pairs > /dev/null")
                .status,
            0);
  std::map<std::string, int> wide;
  for (const std::string command :
       {"graze fuzz --pairs 3000 --executor twin --out c | grep -v '^Wrote '", "graze lanes", "graze check m.pairs",
        "graze repro extreme_scale:1:5 --lanes '*/f32/c*[!t]' --executor twin | grep -v signature",
        "graze explain coplanar_rounded:1:10", "graze explain mixed_scale:1:3 --lanes '*/f32/c*[!t]'",
        "graze explain extreme_scale:1:5", "graze map mixed_scale:1:3 --lanes 'guigue*/f32/c*[!t]' --out m.png"}) {
    const Ran piped = shell.done(command);
    EXPECT_LE(widest(piped.out), 80) << command << '\n' << piped.out;
    const std::string narrow = on_terminal(shell, command.substr(0, command.find(" | ")), 80);
    EXPECT_EQ(without_colour(narrow).find(piped.out.substr(0, piped.out.find('\n'))), 0u) << command;
    wide[command] = widest(on_terminal(shell, command.substr(0, command.find(" | ")), 200));
    EXPECT_LE(wide[command], 200) << command;
  }
  EXPECT_GT(wide["graze explain coplanar_rounded:1:10"], 100);
  EXPECT_GT(wide["graze lanes"], 80);
}

TEST_F(TerminalTest, TheLiveLineNeverWraps) {
  for (const unsigned short columns : std::initializer_list<unsigned short>{30, 80, 140}) {
    const std::string out = "c" + std::to_string(columns);
    const std::string fuzz =
        "graze fuzz --pairs 400000 --threads 1 --strata 'near_*' --lanes '*/cpu' --out " + out + " > /dev/null";
    const std::string text = on_terminal(shell, fuzz, columns);
    EXPECT_NE(text.find('%'), std::string::npos) << text;
    EXPECT_LT(widest(text), columns) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
  expect_done("graze fuzz --pairs 1000 --strata 'near_*' --lanes '*/f32/cpu' --out m > /dev/null");
  const std::string text = on_terminal(shell, "graze minimize m > /dev/null", 40);
  EXPECT_TRUE(has(text, {" left"}));
  EXPECT_LT(widest(text), 40) << text;
}

// Returns the text without its examples, which are not wrapped, so that they can be copied.
std::string without_examples(const std::string& text) {
  std::istringstream in(text);
  std::string kept;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("Example: ")) kept += line + '\n';
  }
  return kept;
}

TEST_F(TerminalTest, HelpFitsAnyTerminalAndIsTheSameInEveryPipe) {
  std::vector<std::string> verbs = {"", "corpus add ", "corpus list ", "corpus verify "};
  for (const std::string& verb : verbs_in_help(shell, "graze")) verbs.push_back(verb + ' ');
  for (const std::string& verb : verbs) {
    const std::string help = "graze " + verb + "--help";
    const std::string piped = shell(help).out;
    EXPECT_EQ(shell("COLUMNS=40 " + help).out, piped) << help;
    EXPECT_EQ(without_colour(on_terminal(shell, help, 80)), piped) << help;
    for (const unsigned short columns : std::initializer_list<unsigned short>{50, 100, 140})
      EXPECT_LE(widest(without_examples(on_terminal(shell, help, columns))), columns) << help;
    EXPECT_LE(widest(on_terminal(shell, help, 80)), 80) << help;
  }
  EXPECT_GT(widest(on_terminal(shell, "graze --help", 140)), 100);
}

TEST_F(ScreenTest, HelpGroupsTheVerbsByTaskAndSaysDefaults) {
  const std::string help = shell("graze --help").out;
  std::size_t last = 0;
  for (const std::string part : {"\nFind ", "  hunt ", "\nUnderstand ", "  explain ", "\nChoose ", "  tune ",
                                 "\nScale ", "  merge ", "\nKeep ", "  corpus ", "\nOptions:\n"}) {
    const std::size_t at = help.find(part, last);
    ASSERT_NE(at, std::string::npos) << part << help;
    last = at;
  }
  EXPECT_EQ(verbs_in_help(shell, "graze").size(), 29u);
  const std::string fuzz = shell("graze fuzz --help").out;
  EXPECT_TRUE(has(fuzz, {"Usage: graze fuzz [OPTIONS]\n", "--pairs N ", "(default: 1000000)", "(default: auto)"}));
  EXPECT_TRUE(has(shell("graze check --help").out, {"Usage: graze check [OPTIONS] FILE\n"}));
}

TEST_F(TerminalTest, StrataAreOneLineEachForProgramsAndWrappedForPeople) {
  const std::string piped = shell("graze strata").out, shown = on_terminal(shell, "graze strata", 80);
  EXPECT_LE(widest(shown), 80);
  EXPECT_LT(std::count(piped.begin(), piped.end(), '\n'), std::count(shown.begin(), shown.end(), '\n'));
  // Does not count "--coordinates f64 …:", "Next: …" and the empty lines before them.
  const auto lines = std::count(piped.begin(), piped.end(), '\n') - 4;
  EXPECT_EQ(shell("graze strata | cut -c1-20 | grep -c '^[a-z]'").out, std::to_string(lines) + "\n");
}

nlohmann::json lane_rows(const Shell& shell) { return nlohmann::json::parse(shell("graze lanes --json").out); }

TEST_F(ScreenTest, LanesSayOnceWhatTheirTwinsAreTrustedFor) {
  std::map<std::string, std::string> status;
  for (const auto& row : lane_rows(shell)) status[row["lane"]] = row["status"];
  if (status.at("moller_1997/f32/cuda-fma") == "available (device)") GTEST_SKIP() << "there is a device";
  const std::string out = shell("graze lanes").out;
  EXPECT_TRUE(has(
      out, {"  moller_1997/f32/cuda-fma             available (twin)\n", "CUDA lanes run by their twins, on the CPU"}));
}

// The build's message without nvcc must be true: it names as unavailable exactly those variants whose lanes have no
// twin.
TEST_F(ScreenTest, TheBuildSaysWhatRunsWithoutNvcc) {
  const std::string text = contents(std::filesystem::path(GRAZE_SOURCE_DIR) / "cmake/cuda.cmake");
  const std::size_t at = text.find("CUDA lanes: run by their twins, on the CPU (built without nvcc); ");
  ASSERT_NE(at, std::string::npos);
  const std::string message = text.substr(at, text.find('\n', at) - at);
  EXPECT_TRUE(has(message, {"is unavailable"}));
  int variants = 0;
  for (const auto& row : lane_rows(shell)) {
    const std::string target = row["target"], status = row["status"];
    if (!target.starts_with("cuda") || status == "available (device)") continue;
    ++variants;
    EXPECT_EQ(message.find(" " + target + ",") != std::string::npos, status.starts_with("unavailable")) << row;
  }
  if (variants == 0) GTEST_SKIP() << "there is a device";
}

}  // namespace
}  // namespace graze::cli
