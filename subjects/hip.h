// SPDX-License-Identifier: Apache-2.0
// Contraction by HIP's compiler for AMD's GPUs, read from their machine code. Nothing runs, so there is no verdict.
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

// The plan of `function`, which takes two triangles, for the target. The source is HIP, CUDA without its headers, or
// C++.   Throws: std::runtime_error with the compiler's first error; Stopped.
ContractionPlan hip_plan(const std::filesystem::path& source, const std::string& function, std::string_view target,
                         const std::vector<std::string>& flags);

// The contractions that nvcc and ptxas make in a CUDA lane, as its twin replays them. Empty without a twin, or for a
// lane without contractions.   folder: of the source.
std::vector<FusedLine> nvidia_plan(const Lane& lane, const std::filesystem::path& folder);

}  // namespace graze::subjects
