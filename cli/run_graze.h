// SPDX-License-Identifier: Apache-2.0
// For tests: runs shell commands in a separate folder, with the built `graze` first on the PATH.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/message_testing.h"
#include "fuzz/sealed.h"

namespace graze::cli {

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// Returns the object's text as Graze would write it, with the correct checksum (fuzz/sealed.h).
inline std::string sealed(const nlohmann::ordered_json& json) { return fuzz::sealed(json).dump(1) + '\n'; }

// Success if the text contains all parts.
inline testing::AssertionResult has(std::string_view text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (text.find(part) == text.npos) return testing::AssertionFailure() << "no '" << part << "' in: " << text;
  return testing::AssertionSuccess() << "found in: " << text;
}

struct Ran {
  int status;  // exit status; 128 + n for signal n
  std::string out, err;
};

class Shell {
 public:
  explicit Shell(const std::string& name)
      : folder(std::filesystem::temp_directory_path() / ("graze-" + name + "-" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  ~Shell() { std::filesystem::remove_all(folder); }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  Ran operator()(const std::string& command) const {
    const std::filesystem::path script = folder / ".command";
    std::ofstream(script) << "cd '" << folder.string() << "'\nPATH='" << GRAZE_BINARY_DIR << "':$PATH\n"
                          << command << "\n";
    const int rc = std::system(("bash '" + script.string() + "' > '" + (folder / ".out").string() + "' 2> '" +
                                (folder / ".err").string() + "' < /dev/null")
                                   .c_str());
    return {WIFEXITED(rc) ? WEXITSTATUS(rc) : 128 + WTERMSIG(rc), contents(folder / ".out"), contents(folder / ".err")};
  }

  // Runs a command that must succeed.
  Ran done(const std::string& command) const {
    Ran ran = (*this)(command);
    EXPECT_EQ(ran.status, 0) << command << '\n' << ran.out << ran.err;
    return ran;
  }

  std::string file(const std::string& name) const { return contents(folder / name); }
  nlohmann::ordered_json json(const std::string& name) const { return nlohmann::ordered_json::parse(file(name)); }

  std::filesystem::path folder;
};

// Returns the verbs that the program's --help lists: the first words of its rows.
inline std::vector<std::string> verbs_in_help(const Shell& shell, const std::string& program) {
  std::istringstream names(shell(program + " --help | sed -n 's/^  \\([a-z][a-z-]*\\) .*/\\1/p'").out);
  return {std::istream_iterator<std::string>(names), {}};
}

// Returns a prefix that sends a command the signal before its `write`-th write to a file (signal_at_write.cpp).
inline std::string signal_at_write(int signal, int write) {
  return "ASAN_OPTIONS=verify_asan_link_order=0 GRAZE_SIGNAL=" + std::to_string(signal) +
         " GRAZE_AT_WRITE=" + std::to_string(write) + " LD_PRELOAD='" + GRAZE_SIGNAL_AT_WRITE + "' ";
}

// Each test has its own shell.
class CommandTest : public testing::Test {
 protected:
  Shell shell{std::string(testing::UnitTest::GetInstance()->current_test_info()->test_suite_name()) + "-" +
              testing::UnitTest::GetInstance()->current_test_info()->name()};

  void expect_done(const std::string& command) const { shell.done(command); }

  // Expects success, and these parts in the standard output.
  void expect_out(const std::string& command, const std::vector<std::string>& parts) const {
    EXPECT_TRUE(has(shell.done(command).out, parts)) << command;
  }

  // Runs the command and sends it `signal` as soon as its handler for SIGTERM is installed; before that, SIGTERM would
  // end it with status 143.
  Ran signalled(const std::string& command, const std::string& signal, const std::string& before = "true") const {
    return shell(command + " & p=$!; until [ $((0x$(awk '/SigCgt/ {print $2}' /proc/$p/status) >> 14 & 1)) = 1 ] && " +
                 before + "; do sleep 0.02; kill -0 $p || exit 99; done; kill -" + signal + " $p; wait $p");
  }

  // Expects this exit status, and one line on stderr that contains these words (core/message_testing.h). On a slow
  // machine, progress lines may precede the line.
  void expect_error(const std::string& command, int status, const std::vector<std::string>& words) const {
    const Ran ran = shell(command);
    EXPECT_EQ(ran.status, status) << command << '\n' << ran.err;
    EXPECT_TRUE(ran.err.ends_with('\n')) << command << '\n' << ran.err;
    const std::string said = std::regex_replace(ran.err, std::regex("^( *[0-9]+%[^\n]*\n)+"), "");
    EXPECT_TRUE(names(said.substr(0, said.empty() ? 0 : said.size() - 1), words)) << command;
  }
};

}  // namespace graze::cli
