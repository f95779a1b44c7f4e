// SPDX-License-Identifier: Apache-2.0
// The contractions that HIP's compiler makes for AMD's GPUs, read from its assembly. The code does not run, so there
// are no verdicts.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/lanes/lanes.h"
#include "subjects/contraction_plan.h"

namespace graze::subjects {

inline constexpr std::string_view kHipTargets[] = {"gfx90a", "gfx1100"};

// Why hipcc cannot compile here; empty if it can.
std::string why_no_hip();

// The contraction plan of `function`, which takes two triangles, for the target. The source is in HIP, CUDA without its
// headers, or C++.   Throws: std::runtime_error with the compiler's first error; Stopped.
ContractionPlan hip_plan(const std::filesystem::path& source, const std::string& function, std::string_view target,
                         const std::vector<std::string>& flags);

// The contractions that nvcc and ptxas make in a CUDA lane, as the lane's twin replays them. Empty if the lane has no
// twin or no contractions.   folder: the folder of the source.
std::vector<FusedLine> nvidia_plan(const Lane& lane, const std::filesystem::path& folder);

}  // namespace graze::subjects
