// SPDX-License-Identifier: Apache-2.0
// Checks the documents. Each `$ command` of a console block must print the text below it. Linked files and named paths
// must exist. README files must be short.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <vector>

#include "cli/run_graze.h"
#include "reports/viewer.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = GRAZE_SOURCE_DIR;

using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Whether the lines match, starting from e and f; "…" matches any number of lines.
bool matches(const Lines& expected, std::size_t e, const Lines& found, std::size_t f) {
  if (e == expected.size()) return f == found.size();
  if (expected[e] == "…")
    return matches(expected, e + 1, found, f) || (f < found.size() && matches(expected, e, found, f + 1));
  return f < found.size() && expected[e] == found[f] && matches(expected, e + 1, found, f + 1);
}

// Shortens the output as the document does: keeps as many lines before and after the "…".
Lines abridged(const Lines& expected, const Lines& found) {
  const auto dots = std::find(expected.begin(), expected.end(), "…");
  const auto before = dots - expected.begin(), behind = expected.end() - dots - 1;
  if (dots == expected.end() || before + behind >= std::ssize(found)) return found;
  Lines lines(found.begin(), found.begin() + before);
  lines.push_back("…");
  lines.insert(lines.end(), found.end() - behind, found.end());
  return lines;
}

// Returns: the tool that the command needs and this machine lacks, or nothing. The subject `cu` and its results need
// NVRTC, and `js` needs Node.
std::string missing_tool(const Shell& shell, const std::string& command) {
  static const std::regex of_cuda("\\bcu\\b"), of_node("\\bjs\\b");
  if (std::regex_search(command, of_cuda) &&
      shell("graze lanes --subject cu=./mine.cu:meet").err.find("NVRTC") != std::string::npos)
    return "NVRTC";
  return std::regex_search(command, of_node) && shell("command -v node").status != 0 ? "Node" : "";
}

// Runs the document's commands in one folder. A block that begins with ```language NAME becomes the file NAME there. If
// an output differs, DOCUMENT.new is written with the current outputs. The test is skipped if a command needs a missing
// tool and all other commands print what they should.
void expect_true_commands(const std::string& document, std::size_t least_commands) {
  const fs::path file = kRoot / document, renewed = file.string() + ".new";
  const Lines lines = lines_of(contents(file));
  const Shell shell(file.stem().string());
  std::ostringstream text;
  std::size_t commands = 0;
  std::map<std::string, int> not_run;  // number of commands by missing tool
  bool in_console = false, all_match = true;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text << lines[i] << '\n';
    if (lines[i].starts_with("```")) in_console = lines[i] == "```console";
    if (const std::size_t space = lines[i].find(' '); lines[i].starts_with("```") && space != std::string::npos) {
      std::ofstream out(shell.folder / lines[i].substr(space + 1));
      while (i + 1 < lines.size() && lines[i + 1] != "```") {
        out << lines[++i] << '\n';
        text << lines[i] << '\n';
      }
      continue;
    }
    if (!in_console || !lines[i].starts_with("$ ")) continue;
    ++commands;
    Lines expected;
    while (i + 1 < lines.size() && !lines[i + 1].starts_with("$ ") && !lines[i + 1].starts_with("```"))
      expected.push_back(lines[++i]);
    if (const std::string tool = missing_tool(shell, lines[i - expected.size()]); !tool.empty()) {
      ++not_run[tool];
      for (const std::string& line : expected) text << line << '\n';
      continue;
    }
    const Ran ran = shell(lines[i - expected.size()].substr(2));
    const Lines found = lines_of(ran.out + ran.err);
    const bool match = matches(expected, 0, found, 0);
    all_match = all_match && match;
    EXPECT_TRUE(match) << lines[i - expected.size()] << '\n' << ran.out << ran.err;
    for (const std::string& line : match ? expected : abridged(expected, found)) text << line << '\n';
  }
  EXPECT_GE(commands, least_commands);
  if (all_match) {
    fs::remove(renewed);
  } else {
    std::ofstream(renewed) << text.str();
    ADD_FAILURE() << "outputs differ from " << document
                  << "; the document with the current outputs: " << renewed.string();
  }
  if (!not_run.empty())
    GTEST_SKIP() << document << ": commands that did not run, by missing tool: " << testing::PrintToString(not_run);
}

TEST(Docs, ReadmePrintsWhatItSays) { expect_true_commands("README.md", 5); }

TEST(Docs, TourPrintsWhatItSays) { expect_true_commands("docs/tour.md", 20); }

TEST(Docs, YourOwnCodePrintsWhatItSays) { expect_true_commands("docs/your_own_code.md", 15); }

TEST(Docs, ToolchainsPrintsWhatItSays) { expect_true_commands("docs/toolchains.md", 4); }

TEST(Docs, DoublePrintsWhatItSays) { expect_true_commands("docs/double.md", 4); }

TEST(Docs, TestingPrintsWhatItSays) {
  setenv("BUILD", fs::path(GRAZE_BINARY_DIR).parent_path().c_str(), 1);
  expect_true_commands("docs/testing.md", 3);
}

TEST(Docs, PythonPrintsWhatItSays) {  // with Debian's interpreter, which has Debian's NumPy
  if (std::system("/usr/bin/python3 -c 'import numpy' 2> /dev/null") != 0) GTEST_SKIP() << "NumPy is not installed";
  setenv("PYTHONPATH", (fs::path(GRAZE_BINARY_DIR).parent_path() / "python").c_str(), 1);
  setenv("PATH", ("/usr/bin:" + std::string(std::getenv("PATH"))).c_str(), 1);
  expect_true_commands("docs/python.md", 2);
  unsetenv("PYTHONPATH");
}

TEST(Docs, Result2012PrintsWhatItSays) {
  setenv("GRAZE", kRoot.c_str(), 1);
  expect_true_commands("docs/results/2012.md", 2);
}

TEST(Docs, ViewerPrintsWhatItSays) {
  if (!reports::has_viewer()) GTEST_SKIP() << "this build has no viewer";
  expect_true_commands("docs/viewer.md", 4);
}

TEST(Docs, TuningPrintsWhatItSays) { expect_true_commands("docs/tuning.md", 10); }

TEST(Docs, QueryPrintsWhatItSays) { expect_true_commands("docs/query.md", 7); }

TEST(Docs, PackagesPrintsWhatItSays) {
  const std::string build = fs::path(GRAZE_BINARY_DIR).parent_path().string();
  setenv("BUILD", build.c_str(), 1);
  setenv("GRAZE", kRoot.c_str(), 1);
  for (const std::string& needed : {build + "/wasm/graze.wasm", build + "/web/node_modules/typescript"})
    if (!fs::exists(needed)) GTEST_SKIP() << "scripts/npm_package needs " << needed;
  if (std::system("python3 -c 'import yaml' 2> /dev/null") != 0) GTEST_SKIP() << "PyYAML is not installed";
  expect_true_commands("docs/packages.md", 6);
}

TEST(Docs, AbridgesAsBefore) {
  EXPECT_EQ(abridged({"a", "…", "z"}, {"a", "b", "c", "y"}), (Lines{"a", "…", "y"}));
  EXPECT_EQ(abridged({"a", "…"}, {"b", "c"}), (Lines{"b", "…"}));
  EXPECT_EQ(abridged({"a", "b"}, {"c"}), Lines{"c"});
  EXPECT_EQ(abridged({"a", "…", "z"}, {"q"}), Lines{"q"});
}

std::vector<fs::path> documents() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    if (entry.path().extension() == ".md") files.push_back(entry.path());
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name.starts_with(".") || name.starts_with("build") || name == "out") continue;
    for (const auto& inner : fs::recursive_directory_iterator(entry))
      if (inner.path().extension() == ".md" && inner.path().string().find("node_modules") == std::string::npos)
        files.push_back(inner.path());
  }
  return files;
}

// Checks [links](to/files), and paths in backticks: `folder/file.h` or `folder/`.
TEST(Docs, WhatTheyNameExists) {
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  const std::regex path(R"(`([a-z]+/[A-Za-z0-9_./-]*(\.(h|inl|cuh?|cpp|ts|py|md|json|pairs|cmake|txt)|/))`)");
  int links = 0, paths = 0;
  for (const fs::path& file : documents()) {
    const std::string text = contents(file);
    for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found, ++links)
      EXPECT_TRUE(fs::exists(file.parent_path() / (*found)[1].str())) << file << " links " << (*found)[1];
    for (std::sregex_iterator found(text.begin(), text.end(), path), end; found != end; ++found) {
      const std::string name = (*found)[1];
      if (!fs::exists(kRoot / name.substr(0, name.find('/')) / "CMakeLists.txt")) continue;  // not one of our folders
      ++paths;
      EXPECT_TRUE(fs::exists(kRoot / name)) << file << " names " << name;
    }
  }
  EXPECT_GE(links, 15);
  EXPECT_GE(paths, 15);
}

// Checks the commits that prose, measurements and published data name. A build of uncommitted sources ("-dirty") counts
// as missing.
TEST(Docs, CommitsThatTheyNameAreInTheHistory) {
  const Shell shell("history");
  const std::string git = "git -C '" + kRoot.string() + "' ";
  if (shell(git + "rev-parse --is-shallow-repository").out != "false\n")
    GTEST_SKIP() << "no git, or not the whole history";
  const auto named_in = [](const fs::path& file, const std::regex& pattern) {
    const std::string text = contents(file);
    std::string ids;
    for (std::sregex_iterator found(text.begin(), text.end(), pattern), end; found != end; ++found)
      ids += " " + ((*found)[1].matched ? (*found)[1] : (*found)[2]).str();
    return ids;
  };
  std::string ids;
  for (const fs::path& file : documents())
    ids += named_in(file, std::regex("`([0-9a-f]{7,12}(?:-dirty)?)`|[Cc]ommit ([0-9a-f]{7,12})\\b"));
  for (const auto& file : fs::directory_iterator(kRoot / "reports/published")) {
    if (file.path().extension() != ".json") continue;
    const std::string of_file = named_in(file, std::regex("\"commit\": ?\"([^\"]+)\""));
    EXPECT_TRUE(!of_file.empty() || file.path().stem().string().ends_with("_timings")) << file;
    ids += of_file;
  }
  for (const auto& file : fs::directory_iterator(kRoot / "docs/measurements"))
    if (file.path().extension() == ".toml") ids += named_in(file, std::regex("(?:commit|by|before) = \"([^\"]+)\""));
  EXPECT_GE(std::count(ids.begin(), ids.end(), ' '), 100);
  const Ran missing = shell("for id in $(echo" + ids + " | tr ' ' '\\n' | sort -u); do " + git +
                            "merge-base --is-ancestor \"$id\" HEAD 2> /dev/null || echo \"$id\"; done");
  EXPECT_EQ(missing.out, "") << "not in the history";
}

TEST(Docs, TheCitationNamesTheProjectsVersionAndLicence) {
  const std::string citation = contents(kRoot / "CITATION.cff");
  std::smatch version;
  const std::string project = contents(kRoot / "CMakeLists.txt");
  ASSERT_TRUE(std::regex_search(project, version, std::regex("project\\(graze VERSION ([0-9.]+) ")));
  EXPECT_TRUE(has(citation, {"\nversion: " + version[1].str() + "\n", "\nlicense: Apache-2.0\n"}));
  EXPECT_TRUE(has(contents(kRoot / "LICENSE"), {"Apache License\n                           Version 2.0"}));
}

TEST(Docs, ReadmesAreShort) {
  EXPECT_LE(lines_of(contents(kRoot / "README.md")).size(), 120u);
  int folders = 0;
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    if (!fs::exists(entry.path() / "CMakeLists.txt") || entry.path().filename().string().starts_with("build")) continue;
    ++folders;
    const fs::path readme = entry.path() / "README.md";
    EXPECT_TRUE(fs::exists(readme)) << readme;
    EXPECT_LE(lines_of(contents(readme)).size(), 15u) << readme;
  }
  EXPECT_GE(folders, 9);
}

}  // namespace
}  // namespace graze::cli
