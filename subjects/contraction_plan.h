// SPDX-License-Identifier: Apache-2.0
// The contraction plan of a build: which products its compiler fuses into additions, and at which lines of the source.
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
  std::string not_read = {};        // why there is none, in words
};

// The plan in the assembly that a compiler made of the source.
ContractionPlan plan_in(std::string_view assembly, const std::filesystem::path& source);

// The plan of what build_source builds. Compiles to assembly.   Throws: as assembly_of.
ContractionPlan contraction_plan(const std::filesystem::path& source, const std::string& function, const Recipe& recipe,
                                 const std::vector<std::string>& flags);

// The plan of a build as records store it: {"f32": {"plan": "3f2a7b1c5d6e7f80", "operations": 14}, "f64": {…}}. It is
// kept beside the build.   build: its name in the cache.   Returns: null if no plan can be read, or if the source no
// longer gives this build.   Throws: Stopped.
nlohmann::ordered_json recorded_plan(const std::string& build, const std::filesystem::path& source,
                                     const std::string& function, const Recipe& recipe,
                                     const std::vector<std::string>& flags);

// How two recorded plans differ: "it fuses other products of f32 (plan 3f2a… then, 9b1c… now)". Empty if they agree
// or one is missing.
std::string plan_difference(const nlohmann::ordered_json& then, const nlohmann::ordered_json& now);

}  // namespace graze::subjects
