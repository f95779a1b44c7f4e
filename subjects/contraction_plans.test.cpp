// SPDX-License-Identifier: Apache-2.0
// Compares the contraction plans of the built-in toolchains and of the cpu-fma lanes with the goldens in
// toolchains/plans.json, by compiler. If a compiler fuses other products, verdicts change, and no other test would show
// the reason.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>

#include "core/message_testing.h"
#include "core/programs/run_program.h"
#include "core/variants.h"
#include "subjects/contraction_plan.h"
#include "subjects/published.h"
#include "subjects/subjects.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const fs::path kGoldens = fs::path(GRAZE_SOURCE_DIR) / "subjects/toolchains/plans.json";

// "GCC 12.2.0" or "clang 14.0.6", from the first line of the compiler's --version. Empty for other compilers, or if the
// standard library's headers are missing.
std::string version_of(const std::string& compiler) {
  const Scratch scratch(cache_folder());
  int status = 0;
  const std::string said = shell_output(compiler + " --version", scratch.path(), status);
  const std::string line = said.substr(0, said.find('\n'));
  std::smatch found;
  if (status != 0 || !std::regex_search(line, found, std::regex("[0-9]+\\.[0-9]+\\.[0-9]+"))) return "";
  // clang can compile for every processor, but may lack a processor's headers.
  shell_output("printf '#include <tuple>' | " + compiler + " -x c++ -fsyntax-only -", scratch.path(), status);
  return status != 0 ? "" : (line.find("clang") != line.npos ? "clang " : "GCC ") + found.str();
}

struct ContractionPlans : testing::Test {
  static inline fs::path folder;
  static inline Json goldens;
  std::string without_golden;

  static void SetUpTestSuite() {
    folder = fs::path(testing::TempDir()) / ("plans-" + std::to_string(getpid()));
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    goldens = Json::parse(std::ifstream(kGoldens));
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  // Compares the plans with their goldens. Writes plans that differ, or that have no golden, into plans.json.new.
  void expect_golden(const std::string& builder, const std::string& compiler, const Json& found) {
    const Json golden = goldens.value(builder, Json::object()).value(compiler, Json());
    if (golden == found) return;
    goldens[builder][compiler] = found;
    std::ofstream(kGoldens.string() + ".new") << goldens.dump(1) << '\n';
    if (golden.is_null()) {
      without_golden += fmt::format("{} by {}; ", builder, compiler);
      return;
    }
    for (const auto& [name, plan] : found.items()) {
      EXPECT_EQ(plan, golden.value(name, Json())) << builder << " with " << compiler << " fuses other products in "
                                                  << name << "; if that is right, scripts/update_generated accepts it";
    }
    EXPECT_EQ(found.size(), golden.size()) << builder;
  }
  void skip_without_golden() const {
    if (!without_golden.empty() && !HasFailure())
      GTEST_SKIP() << "no golden: " << without_golden << "scripts/update_generated adds it";
  }
};

TEST_F(ContractionPlans, OfBuiltInToolchainsAreTheGoldens) {
  int compared = 0;
  for (const Toolchain& toolchain : built_in_toolchains()) {
    if (toolchain.rounding != Rounding::contracted) continue;
    const std::string compiler = version_of(toolchain.cxx);
    if (compiler.empty()) {
      std::printf("not installed: %s (install %s)\n", toolchain.name.c_str(), toolchain.needs.c_str());
      continue;
    }
    Json found;
    for (const Lane& lane : published_lanes()) {
      const std::string id(lane.info->id);
      if (found.contains(id + "/f32")) continue;
      const fs::path source = published_source(lane);
      const ContractionPlan plan = contraction_plan(source, kPublishedFunction, recipe_of(toolchain, source), {});
      ASSERT_EQ(plan.not_read, "") << toolchain.name;
      found[id + "/f32"] = plan_in_words(plan.f32);
      found[id + "/f64"] = plan_in_words(plan.f64);
    }
    expect_golden(toolchain.name, compiler, found);
    ++compared;
  }
  if (compared == 0) GTEST_SKIP() << "no toolchain that contracts is installed";
  skip_without_golden();
}

// A comment above the code moves lines, but does not change the plan. Changed code or operations change the plan.
TEST_F(ContractionPlans, DoNotChangeWithLineNumbers) {
  const auto plan_of = [](const std::string& source, const char* instruction) {
    fs::create_directories(folder);
    std::ofstream(folder / "m.c") << source;
    const auto line = std::count(source.begin(), source.end(), '\n');
    std::vector<FusedLine> plan = fused_lines(
        "\t.file 1 \"m.c\"\n\t.loc 1 " + std::to_string(line) + " 3\n\t" + instruction + "\t%xmm1, %xmm2, %xmm3\n", "");
    read_code(plan, folder);
    EXPECT_EQ(plan.size(), 1u);
    return plan_hash(plan);
  };
  const std::uint64_t hash = plan_of("x = a * b + c;\n", "vfmadd231ss");
  EXPECT_EQ(plan_of("// why\n\n  x = a * b + c;\n", "vfmadd231ss"), hash);
  EXPECT_NE(plan_of("x = a * b + d;\n", "vfmadd231ss"), hash);
  EXPECT_NE(plan_of("x = a * b + c;\n", "vfmsub231ss"), hash);
  EXPECT_NE(plan_of("x = a * b + c;\n", "vfmadd231sd"), hash);
}

// A campaign records the plan of each toolchain's lane. Later verbs refuse a different build, and name the plan that
// changed.
TEST_F(ContractionPlans, AreRecordedAndNamedWhenABuildIsRefused) {
  if (version_of("x86_64-linux-gnu-g++").empty()) GTEST_SKIP() << "no x86_64-linux-gnu-g++";
  fs::create_directories(folder);
  std::ofstream(folder / "m.cpp") << "bool intersects(const float* a, const float* b) {\n"
                                     "  return a[0] * b[1] + a[2] * b[3] < b[0];\n}\n";
  const auto rows = [](const char* flag) {
    return parse_toolchains("mine.toml",
                            std::string("[[toolchain]]\nname = \"mine\"\ncxx = \"x86_64-linux-gnu-g++ -O2 ") +
                                "-march=x86-64-v3 " + flag + "\"\n");
  };
  const auto opened_as = [&](const std::string& name, const char* flag) {
    Wanted wanted = parse_subject(name + '=' + (folder / "m.cpp").string());
    wanted.toolchains = rows(flag);
    open(wanted);
    return record({name + "/f32/mine"});
  };
  const Json fused = opened_as("fused", ""), again = opened_as("again", ""),
             off = opened_as("off", "-ffp-contract=off");
  const auto plan = [](const Json& record, const char* scalar) {
    return record[0]["toolchains"][0]["contraction"][scalar];
  };
  ASSERT_TRUE(fused[0]["toolchains"][0].contains("contraction")) << fused;
  EXPECT_GT(plan(fused, "f32")["operations"], 0);
  EXPECT_EQ(plan(fused, "f64")["operations"], 0);
  EXPECT_EQ(plan(fused, "f32"), plan(again, "f32"));
  EXPECT_EQ(plan(off, "f32")["operations"], 0);
  EXPECT_NE(plan(off, "f32"), plan(fused, "f32"));

  Json spec{{"subjects", fused}};
  EXPECT_TRUE(open_recorded(spec).empty());
  Json& toolchain = spec["subjects"][0]["toolchains"][0];
  toolchain["build"] = "0123456789abcdef";  // as if another compiler version had built it
  const auto refusal = [&] { return error_of([&] { open_recorded(spec); }); };
  EXPECT_NE(refusal().find("0123456789abcdef then"), std::string::npos) << refusal();
  EXPECT_EQ(refusal().find("fuses"), std::string::npos) << refusal();
  toolchain["contraction"]["f32"] = {{"plan", "3f2a3f2a3f2a3f2a"}, {"operations", 2}};
  EXPECT_TRUE(names(refusal(), {"mine", "fuses different products in f32", "3f2a3f2a3f2a3f2a then",
                                plan(fused, "f32")["plan"].get<std::string>() + " now"}));
}

// If the cached plan is damaged or cannot be replaced, it is read again from the compiler's assembly.
TEST_F(ContractionPlans, AreKeptBesideTheBuild) {
  if (version_of("x86_64-linux-gnu-g++").empty()) GTEST_SKIP() << "no x86_64-linux-gnu-g++";
  fs::create_directories(folder);
  const fs::path source = folder / "kept.cpp";
  std::ofstream(source) << "bool intersects(const float* a, const float* b) { return a[0] * b[1] + a[2] < b[0]; }\n";
  const Recipe recipe = recipe_of(Toolchain{"v3", "x86_64-linux-gnu-g++ -O2 -march=x86-64-v3", ""}, source);
  const std::string build = build_source(source, "intersects", recipe, {}).file.stem();
  const Json plan = recorded_plan(build, source, "intersects", recipe, {});
  EXPECT_GT(plan["f32"]["operations"], 0) << plan;
  const fs::path kept = cache_folder() / (build + ".plan");
  ASSERT_TRUE(fs::exists(kept));
  std::ofstream(kept, std::ios::app) << "x";
  EXPECT_EQ(recorded_plan(build, source, "intersects", recipe, {}), plan);
  fs::rename(kept, folder / "plan");
  fs::create_directories(kept / "in the way");
  EXPECT_EQ(recorded_plan(build, source, "intersects", recipe, {}), plan);
  fs::remove_all(kept);
  fs::rename(folder / "plan", kept);
  fs::remove(source);
  EXPECT_EQ(recorded_plan(build, source, "intersects", recipe, {}), plan);
  EXPECT_TRUE(recorded_plan("0123456789abcdef", source, "intersects", recipe, {}).is_null());
}

// Toolchains that round as written fuse nothing, and neither do toolchains for the x87. Tests one algorithm.
TEST_F(ContractionPlans, WhereNothingIsContractedNothingIsFused) {
  const Lane& lane = published_lanes().front();
  for (const Toolchain& toolchain : built_in_toolchains()) {
    if (toolchain.rounding == Rounding::contracted || version_of(toolchain.cxx).empty()) continue;
    const fs::path source = published_source(lane);
    const ContractionPlan plan = contraction_plan(source, kPublishedFunction, recipe_of(toolchain, source), {});
    EXPECT_TRUE(plan.f32.empty() && plan.f64.empty()) << toolchain.name;
    EXPECT_EQ(plan.not_read.empty(), toolchain.name != "wasm") << toolchain.name;
  }
}

// GRAZE_FMA_COMMAND compiles the cpu-fma lanes' code with the flags of a Graze release.
TEST_F(ContractionPlans, OfCpuFmaAreTheGoldens) {
#if defined(__x86_64__)
  const Scratch scratch(cache_folder());
  const fs::path assembly = scratch.path() / "blocks.s";
  int status = 0;
  const std::string said =
      shell_output(std::string(GRAZE_FMA_COMMAND) + " -g1 -S -o " + assembly.string(), scratch.path(), status);
  ASSERT_EQ(status, 0) << said;
  std::ifstream in(assembly);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  Json found;
  for (const char* scalar : {"f32", "f64"}) {
    std::vector<FusedLine> plan = fused_lines(text, GRAZE_SOURCE_DIR, scalar);
    read_code(plan, GRAZE_SOURCE_DIR);
    found[scalar] = plan_in_words(plan);
  }
  expect_golden("cpu-fma", version_of(GRAZE_FMA_COMPILER), found);
  skip_without_golden();
#else
  GTEST_SKIP() << "cpu-fma is contracted on x86-64";
#endif
}

}  // namespace
}  // namespace graze::subjects
