// SPDX-License-Identifier: Apache-2.0
#include "subjects/opencl_code.h"

#include <fmt/format.h>

#include <stdexcept>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/programs/run_program.h"
#include "core/programs/supervisor_process.h"
#include "core/text.h"
#include "subjects/source_build.h"
#include "subjects/toolchains/command_of.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

fs::path runner() { return beside_this("graze-subject-opencl"); }

std::string last_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

}  // namespace

std::vector<Toolchain> opencl_toolchains(const std::string& function) {
  std::vector<Toolchain> result;
  const std::tuple<const char*, const char*, Rounding> modes[] = {{"opencl", "default", Rounding::contracted},
                                                                  {"opencl-nofma", "nofma", Rounding::rounded},
                                                                  {"opencl-mad", "mad", Rounding::contracted},
                                                                  {"opencl-fast", "fast", Rounding::fast}};
  for (const auto& [name, mode, rounding] : modes) {
    Toolchain& toolchain = result.emplace_back();
    toolchain.name = name;
    toolchain.run = fmt::format("{} {{}} {} any {}", shell_word(runner().string()), shell_word(function), mode);
    toolchain.needs = "the runner of a build with opencl-c-headers; a driver such as pocl-opencl-icd";
    toolchain.rounding = rounding;
  }
  return result;
}

Built built_for_opencl(const fs::path& source, const std::shared_ptr<const SealedCopy>& content,
                       const std::string& run) {
  const Scratch scratch(cache_folder());
  int status = 0;
  const std::string said =
      shell_output(command_of(run, shell_word(source.string())) + " < /dev/null > /dev/null", scratch.path(), status);
  if (status != 0) throw std::runtime_error(cannot("compile", source, last_line(said)));
  static const std::string devices =
      shell_output(shell_word(runner().string()) + " --platforms", scratch.path(), status);
  const std::uint64_t hash = fnv1a(devices, fnv1a(run.substr(run.rfind(" {} ")), fnv1a(code_in(source))));
  return {fmt::format("{:016x}.cl", hash), "", content, devices.substr(0, devices.find('\n'))};
}

}  // namespace graze::subjects
