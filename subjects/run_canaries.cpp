// SPDX-License-Identifier: Apache-2.0
#include "subjects/run_canaries.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "core/programs/run_program.h"
#include "core/text.h"
#include "subjects/source_build.h"
#include "subjects/toolchains/command_of.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<const char*, std::string_view> kSource[] = {
#include "subjects/canaries.inc"
};

std::string complaint_in(const std::string& output) {
  const std::string line = line_with(output, {"error", "sorry", "not found"});
  return line.empty() ? "no output" : line;
}

constexpr double kToCompile = 300, kToRun = 60;  // seconds

}  // namespace

bool is_cxx(std::string_view compiler) {
  const std::size_t begin = compiler.find_first_not_of(' ');
  if (begin == compiler.npos) return false;
  const char quote = compiler[begin] == '\'' || compiler[begin] == '"' ? compiler[begin] : ' ';
  const std::string program(compiler.substr(begin, compiler.find(quote, begin + 1) - begin));
  return fs::path(program).filename().string().find("++") != std::string::npos;
}

std::string run_canaries(const std::string& compiler, const std::string& run) {
  const Scratch scratch(cache_folder());
  const bool cxx = is_cxx(compiler);
  const fs::path source = scratch.path() / (cxx ? "canaries.cpp" : "canaries.c"), program = scratch.path() / "canaries";
  write_atomically(source, kSource[0].second);
  // The same standard as for subjects, unless the command names one itself.
  const char* standard = compiler.find("-std=") != compiler.npos ? "" : cxx ? "-std=gnu++20" : "-std=gnu11";
  int status = 0;
  const std::string said = shell_output(
      fmt::format("{} {} {} -o {} -lm", compiler, standard, shell_word(source.string()), shell_word(program.string())),
      scratch.path(), status, kToCompile);
  if (status != 0)
    throw std::runtime_error(fmt::format("cannot compile the canaries with '{}': {}", compiler, complaint_in(said)));
  const std::string output =
      shell_output(command_of(run, shell_word(program.string())), scratch.path(), status, kToRun);
  if (status != 0)
    throw std::runtime_error(fmt::format(
        "the canaries compiled with '{}' ended with exit status {}: {}{}", compiler, status, complaint_in(output),
        status == 126 ? "; for another processor, add -static and name an emulator with --run" : ""));
  return output;
}

std::optional<Claim> claim_of(const std::string& compiler) {
  const Scratch scratch(cache_folder());
  int status = 0;
  const std::string macros =
      shell_output(fmt::format("{} -dM -E -x {} /dev/null", compiler, is_cxx(compiler) ? "c++" : "c"), scratch.path(),
                   status, kToCompile);
  if (status != 0) throw std::runtime_error(fmt::format("'{}' cannot preprocess: {}", compiler, complaint_in(macros)));
  return documented_claim(compiler, macros);
}

}  // namespace graze::subjects
