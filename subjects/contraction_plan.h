// SPDX-License-Identifier: Apache-2.0
// The contraction plan of a build lists the products that its compiler fuses into additions, by line of the source.
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
  std::vector<FusedLine> f32, f64;  // the operations of floats, and of doubles
  std::string not_read = {};        // the reason why there is no plan, in words; else empty
};

// Reads the plan from the assembly that a compiler made from the source.
ContractionPlan plan_in(std::string_view assembly, const std::filesystem::path& source);

// The plan of the build that build_source makes with these arguments. Compiles to assembly.   Throws: as assembly_of.
ContractionPlan contraction_plan(const std::filesystem::path& source, const std::string& function, const Recipe& recipe,
                                 const std::vector<std::string>& flags);

// The plan of a build in the form of records: {"f32": {"plan": "3f2a7b1c5d6e7f80", "operations": 14}, "f64": {…}}. The
// cache keeps the plan beside the build.   build: the build's name in the cache.   Returns: null if no plan can be
// read, or if the source no longer gives this build.   Throws: Stopped.
nlohmann::ordered_json recorded_plan(const std::string& build, const std::filesystem::path& source,
                                     const std::string& function, const Recipe& recipe,
                                     const std::vector<std::string>& flags);

// The difference of two recorded plans: "it fuses other products of f32 (plan 3f2a… then, 9b1c… now)". Empty if the
// plans agree or one of them is missing.
std::string plan_difference(const nlohmann::ordered_json& then, const nlohmann::ordered_json& now);

}  // namespace graze::subjects
