// SPDX-License-Identifier: Apache-2.0
// A build's contraction plan lists the products that its compiler fuses into additions, by source line.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "subjects/source_build.h"
#include "subjects/toolchains/assembly.h"

namespace graze::subjects {

struct ContractionPlan {
  std::vector<FusedLine> f32, f64;  // lines with fused operations on floats; on doubles
  std::string not_read = {};        // why there is no plan, in words; empty if there is one
};

// Reads the plan from a compiler's assembly for the source.
ContractionPlan plan_in(std::string_view assembly, const std::filesystem::path& source);

// The plan of the build that build_source makes with these arguments. Compiles the source to assembly.   Throws: as
// assembly_of.
ContractionPlan contraction_plan(const std::filesystem::path& source, const std::string& function, const Recipe& recipe,
                                 const std::vector<std::string>& flags);

// A build's plan as a record: {"f32": {"plan": "3f2a7b1c5d6e7f80", "operations": 14}, "f64": {…}}. The cache keeps the
// plan beside the build.   build: the build's name in the cache.   Returns: null if no plan can be read, or if the
// source no longer gives this build.   Throws: Stopped.
nlohmann::ordered_json recorded_plan(const std::string& build, const std::filesystem::path& source,
                                     const std::string& function, const Recipe& recipe,
                                     const std::vector<std::string>& flags);

// The difference between two recorded plans: "it fuses other products of f32 (plan 3f2a… then, 9b1c… now)". Empty if
// the plans agree or one of them is missing.
std::string plan_difference(const nlohmann::ordered_json& then, const nlohmann::ordered_json& now);

}  // namespace graze::subjects
