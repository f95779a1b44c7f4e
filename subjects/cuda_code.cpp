// SPDX-License-Identifier: Apache-2.0
#include "subjects/cuda_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/fnv1a.h"
#include "core/programs/kept_file.h"
#include "core/programs/run_program.h"
#include "core/programs/supervisor_process.h"
#include "subjects/source_build.h"

namespace graze::subjects {

namespace fs = std::filesystem;

std::shared_ptr<const SealedCopy> twin_of(const cuda::CudaBuild& build) {
  if (build.twin.empty()) return nullptr;
  const std::optional<std::string> bytes = kept_content(build.twin);
  if (!bytes)
    throw std::runtime_error(fmt::format("{} changed after it was built; run the command again", build.twin.string()));
  return std::make_shared<SealedCopy>(build.twin.filename().string(), *bytes);
}

Code code_of(const cuda::CudaBuild& build, const Wanted& wanted, bool on_device,
             std::shared_ptr<const SealedCopy> twin) {
  Code code{"library", build.twin.string(), "", std::string(name(build.scalar)), wanted.timeout, wanted.memory};
  if (!on_device) {
    code.content = std::move(twin);
    return code;
  }
  const fs::path ptx = cache_folder() / fmt::format("{:016x}.ptx", fnv1a(build.ptx));
  write_atomically(ptx, build.ptx);
  code.kind = "device";
  code.alone = true;
  code.what = ptx.string();
  code.content = std::make_shared<SealedCopy>(ptx.filename().string(), build.ptx);
  return code;
}

KernelCosts kernel_costs(std::span<const cuda::CudaBuild* const> builds) {
  constexpr int kPasses = 9;
  const fs::path program = beside_this("graze-subject-device");
  if (!fs::exists(program)) throw std::runtime_error("built without CUDA");
  const Scratch scratch(cache_folder());
  std::vector<std::string> words{program.string(), "--time", std::to_string(kPairsOfKernelCosts),
                                 std::to_string(kPasses)};
  for (std::size_t b = 0; b < builds.size(); ++b) {
    const fs::path ptx = scratch.path() / fmt::format("{}.ptx", b);
    write_atomically(ptx, builds[b]->ptx);
    words.insert(words.end(), {std::string(name(builds[b]->scalar)), ptx.string()});
  }
  std::string output;
  const int status = run_program({.words = words, .seconds = 60, .namespaces = false}, scratch.path(), output);
  std::istringstream lines(output);
  KernelCosts costs;
  std::getline(lines, costs.device);
  if (status != 0) throw std::runtime_error(status == 1 ? costs.device : fmt::format("it ended with {}", status));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    costs.nanoseconds.emplace_back(std::istream_iterator<double>(numbers), std::istream_iterator<double>());
  }
  const auto incomplete = [](const std::vector<double>& passes) { return passes.size() != std::size_t{kPasses}; };
  if (costs.nanoseconds.size() != builds.size() || std::ranges::any_of(costs.nanoseconds, incomplete))
    throw std::runtime_error("the output of graze-subject-device cannot be read");
  return costs;
}

}  // namespace graze::subjects
