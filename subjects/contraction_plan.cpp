// SPDX-License-Identifier: Apache-2.0
#include "subjects/contraction_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "core/programs/kept_file.h"
#include "core/programs/run_program.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kScalars[] = {"f32", "f64"};

// The compiler's target processor, as -dumpmachine reports it; empty if it reports none.
std::string target_of(const std::string& compiler) {
  const Scratch scratch(cache_folder());
  int status = 0;
  const std::string said = shell_output(compiler + " -dumpmachine", scratch.path(), status);
  return status == 0 ? said.substr(0, said.find('\n')) : "";
}

// Whether the compiler has written its intermediate language instead of assembly, as with -flto.
bool is_for_link_time(const std::string& assembly) {
  return assembly.find(".gnu.lto_") != assembly.npos || assembly.starts_with("; ModuleID");
}

Json row_of(const std::vector<FusedLine>& plan) {
  Json row = plan_json(plan);
  row.erase("lines");
  return row;
}

// The plan in a cached file, without the checksum line. Null if there is no plan.
Json kept_plan(const fs::path& file) {
  const std::string text = kept_content(file).value_or("");
  const Json plan = Json::parse(text.substr(0, text.find('\n')), nullptr, false);
  return plan.is_object() ? plan : Json();
}

// Keeps the plan for later runs. If it cannot be written, later runs compile the source again.
void keep_plan(const Json& plan, const fs::path& file) {
  try {
    const Scratch scratch(cache_folder());
    write_atomically(scratch.path() / "plan", plan.dump() + '\n');
    keep_file(scratch.path() / "plan", file);
  } catch (const std::runtime_error&) {
  }
}

}  // namespace

ContractionPlan plan_in(std::string_view assembly, const fs::path& source) {
  const fs::path folder = fs::absolute(source).lexically_normal().parent_path();
  ContractionPlan plan{fused_lines(assembly, folder, "f32"), fused_lines(assembly, folder, "f64")};
  for (std::vector<FusedLine>* lines : {&plan.f32, &plan.f64}) read_code(*lines, folder);
  return plan;
}

ContractionPlan contraction_plan(const fs::path& source, const std::string& function, const Recipe& recipe,
                                 const std::vector<std::string>& flags) {
  if (const std::string why = why_not_read(target_of(recipe.compiler)); !why.empty()) return {{}, {}, why};
  const std::string assembly = assembly_of(source, function, recipe, flags);
  if (is_for_link_time(assembly)) return {{}, {}, "with -flto the compiler writes no assembly"};
  return plan_in(assembly, source);
}

Json recorded_plan(const std::string& build, const fs::path& source, const std::string& function, const Recipe& recipe,
                   const std::vector<std::string>& flags) {
  const fs::path file = cache_folder() / (build + ".plan");
  if (Json kept = kept_plan(file); !kept.is_null()) return kept;
  try {
    const ContractionPlan plan = contraction_plan(source, function, recipe, flags);
    const Built again = build_source(source, function, recipe, flags);
    if (!plan.not_read.empty() || again.file.stem() != build) return nullptr;
    const Json recorded = {{"f32", row_of(plan.f32)}, {"f64", row_of(plan.f64)}};
    if (again.not_covered.empty()) keep_plan(recorded, file);
    return recorded;
  } catch (const std::runtime_error&) {  // the compiler writes no assembly, or the source is missing
    return nullptr;
  }
}

std::string plan_difference(const Json& then, const Json& now) {
  std::vector<std::string> differ;
  const auto of = [](const Json& plans, const char* scalar) {
    return plans.is_object() ? plans.value(scalar, Json()) : Json();
  };
  for (const char* scalar : kScalars) {
    const Json old = of(then, scalar), found = of(now, scalar);
    if (old.is_object() && found.is_object() && old != found)
      differ.push_back(fmt::format("{} (plan {} then, {} now)", scalar, old.at("plan").get<std::string>(),
                                   found.at("plan").get<std::string>()));
  }
  return differ.empty() ? "" : fmt::format("it fuses different products in {}", fmt::join(differ, ", and in "));
}

}  // namespace graze::subjects
