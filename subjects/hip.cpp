// SPDX-License-Identifier: Apache-2.0
#include "subjects/hip.h"

#include <fmt/format.h>

#include <map>

#include "core/programs/run_program.h"
#include "cuda/twin/twin.h"
#include "subjects/source_build.h"

namespace graze::subjects {

namespace fs = std::filesystem;

std::string why_no_hip() { return on_path("hipcc").empty() ? "no hipcc (install hipcc)" : ""; }

ContractionPlan hip_plan(const fs::path& source, const std::string& function, std::string_view target,
                         const std::vector<std::string>& flags) {
  // -nogpulib leaves out AMD's own library, which hipcc may lack for the target. Calls of its functions then remain
  // calls, into which nothing is fused. The last flag turns off dual instructions, each of which would combine
  // operations from two lines.
  const Recipe recipe{fmt::format("hipcc -x hip -O3 --offload-arch={} --cuda-device-only -nogpulib -mllvm "
                                  "-amdgpu-enable-vopd=0",
                                  target),
                      "-std=gnu++20", "", false, true};
  return plan_in(assembly_of(source, function, recipe, flags), source);
}

std::vector<FusedLine> nvidia_plan(const Lane& lane, const fs::path& folder) {
  std::map<std::pair<std::string, int>, int> by_line;
  for (const cuda::ContractionSite& site : cuda::contraction_sites(lane)) {
    const fs::path within = fs::path(site.at.file).lexically_relative(folder);
    ++by_line[{within.empty() || *within.begin() == ".." ? site.at.file : within.string(), site.at.line}];
  }
  std::vector<FusedLine> plan;
  for (const auto& [place, count] : by_line)
    plan.push_back({place.first, place.second, fmt::format("madd {} x{}", name(lane.scalar), count), count, ""});
  read_code(plan, folder);
  return plan;
}

}  // namespace graze::subjects
