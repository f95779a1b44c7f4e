// SPDX-License-Identifier: Apache-2.0
// Tests toolchains: their files, their lanes, and contractions in their assembly. Skips missing toolchains.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/lanes/verdicts.h"
#include "core/message_testing.h"
#include "strata/strata.h"
#include "subjects/rebuilt.h"
#include "subjects/source_build.h"
#include "subjects/subjects.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

struct Toolchains : testing::Test {
  static inline fs::path folder;
  static inline std::vector<Pair> pairs;  // of all strata

  static void SetUpTestSuite() {
    folder = fs::path(testing::TempDir()) / ("toolchains-" + std::to_string(getpid()));
    fs::create_directories(folder);
    setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
    for (const strata::StratumInfo& stratum : strata::kStrata) {
      for (std::uint64_t i = 0; i < 1000; ++i) pairs.push_back(strata::generate(3, stratum.stratum, i));
    }
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static std::string write(const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
  static void open_published(const std::string& id, const std::string& list) {
    Wanted wanted{id, "published", {}, 60};
    wanted.toolchains = selected_toolchains(list);
    open(wanted);
  }
};

TEST_F(Toolchains, FilesAreRead) {
  const std::vector<Toolchain> found = parse_toolchains("mine.toml", R"(
[[toolchain]]
name = "mac"
cxx = "oa64-clang++ -O2"
run = "ssh mac {}"
needs = "osxcross"
strict = "-ffp-contract=off"
rounding = "contracted"
[[toolchain]]
name = "old"
cc = "gcc-4.4 -O2"
)");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], (Toolchain{"mac", "oa64-clang++ -O2", "", "ssh mac {}", "osxcross", "-ffp-contract=off",
                                 Rounding::contracted}));
  EXPECT_EQ(found[1], (Toolchain{"old", "", "gcc-4.4 -O2"}));
  for (const Toolchain& toolchain : found) EXPECT_EQ(toolchain_of_json(to_json(toolchain)), toolchain);
}

TEST_F(Toolchains, BadFilesGetOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "mine.toml: expected a table [[toolchain]], found none"},
      {"toolchain = 3", "mine.toml: expected a table [[toolchain]], found none"},
      {"[[toolchain]]\nname = \"x\"", "mine.toml:1: expected cxx or cc, the command of a compiler, found neither"},
      {"[[toolchain]]\ncxx = \"c++\"", "mine.toml:1: expected name = "},
      {"[[toolchain]]\nname = \"cpu\"\ncxx = \"c++\"", "mine.toml:1: expected a name that no variant of Graze has"},
      {"[[toolchain]]\nname = \"a/b\"\ncxx = \"c++\"", "mine.toml:1: expected name = "},
      {"[[toolchain]]\nname = \"x\"\ncxx = 3", "mine.toml:3: expected a text of one line, found 3"},
      {"[[toolchain]]\nname = \"x\"\ncpp = \"c++\"",
       "mine.toml:3: expected name, cxx, cc, run, needs, strict, rounding"},
      {"[[toolchain]]\nname = \"x\"\ncxx = \"c++\"\nrounding = \"none\"",
       "mine.toml:4: expected rounded, contracted, excess, fast, found \"none\""},
      {"[[toolchain]]\nname = \"x\"\ncxx = \"c\"\n[[toolchain]]\nname = \"x\"\ncxx = \"c\"",
       "mine.toml:4: expected another name, found \"x\" again"},
      {"[[", "mine.toml:1: expected TOML, found "}};
  for (const auto& [text, message] : cases) {
    const std::string error = error_of([&] { parse_toolchains("mine.toml", text); });
    EXPECT_TRUE(error.starts_with(message)) << error;
  }
}

TEST_F(Toolchains, AreSelectedByNameAndByFile) {
  EXPECT_EQ(selected_toolchains("all"), built_in_toolchains());
  EXPECT_EQ(selected_toolchains("x87,arm64-gcc").size(), 2u);
  EXPECT_EQ(selected_toolchains("x87*").size(), 3u);
  const std::string file = write("mine.toml", "[[toolchain]]\nname = \"x87\"\ncxx = \"mine\"\n");
  ASSERT_EQ(selected_toolchains(file).size(), 1u);
  EXPECT_EQ(selected_toolchains("x87," + file)[0].cxx, "mine");
  EXPECT_EQ(list_of(selected_toolchains("x86-gcc," + file)), "x86-gcc," + file);
  EXPECT_THROW(selected_toolchains("arm46-gcc"), UsageError);
  EXPECT_THROW(selected_toolchains(""), UsageError);
}

// If every operation is rounded, all compilers and processors must give the same verdicts; so this test also checks the
// protocol, the emulator's arithmetic and the sources. With contraction or excess precision, some verdicts differ.
TEST_F(Toolchains, OfPublishedAlgorithmsDifferOnlyWhereTheyDoNotRound) {
  open_published("interval_overlap", "x86-gcc,x86-gcc-v3,x86-clang-v3-off,x87,arm64-gcc,arm64-gcc-off,wasm");
  int compared = 0;
  for (const char* scalar : {"f32", "f64"}) {
    const std::string of = std::string("interval_overlap/") + scalar + '/';
    const std::vector<Verdict> ours = verdicts_of(find_lane(of + "cpu")->decide, pairs);
    for (const char* name :
         {"x86-gcc", "x86-gcc-v3", "x86-clang-v3-off", "x87", "arm64-gcc", "arm64-gcc-off", "wasm"}) {
      const Lane* lane = find_lane(of + name);
      ASSERT_TRUE(lane) << name;
      if (!lane->decide) {
        std::printf("not installed: %s: %s\n", name, lane->evidence.c_str());
        EXPECT_FALSE(lane->evidence.empty());
        continue;
      }
      ++compared;
      const Toolchain* toolchain = toolchain_of(*lane);
      ASSERT_TRUE(toolchain);
      EXPECT_EQ(verdicts_of(lane->decide, pairs) == ours, toolchain->rounding == Rounding::rounded) << lane->id;
    }
  }
  EXPECT_GE(compared, 4);  // at least these, because GCC builds Graze
}

// If the assembly is edited to round every fused product first, the program agrees with the strict build on all pairs.
TEST_F(Toolchains, TheAssemblyShowsEveryFusedProduct) {
  open_published("moller_1997", "x86-gcc-v3,arm64-gcc,arm64-clang,x86-clang-v3-fast");
  int checked = 0;
  for (const char* name : {"x86-gcc-v3", "arm64-gcc", "arm64-clang", "x86-clang-v3-fast"}) {
    const Lane& lane = *find_lane(std::string("moller_1997/f32/") + name);
    if (!lane.decide) continue;
    const std::vector<FusedLine> lines = fused_lines_of(lane);
    ASSERT_GT(lines.size(), 3u) << name;
    EXPECT_EQ(plan_hash(lines), plan_hash(fused_lines_of(lane)));
    const Opened& subject = *opened("moller_1997");
    const Recipe recipe = recipe_of(*toolchain_of(lane), subject.file);
    const fs::path within = subject.file.parent_path();
    std::string assembly = assembly_of(subject.file, function_of(subject), recipe, {});
    for (const FusedLine& line : lines) {
      EXPECT_TRUE(line.file.starts_with("core/")) << line.file;
      const auto rounded = with_rounded_products(assembly, within, line);
      ASSERT_TRUE(rounded) << line.place();
      assembly = *rounded;
    }
    EXPECT_TRUE(fused_lines(assembly, within).empty());
    Code code{"program", toolchain_of(lane)->run, "", "any", 60};
    code.content = build_assembly(assembly, recipe, {}).content;
    for (const Scalar scalar : {Scalar::f32, Scalar::f64}) {
      ForeignProcesses rounded(code, scalar);
      const Lane& cpu = *find_lane(std::string("moller_1997/") + std::string(graze::name(scalar)) + "/cpu");
      EXPECT_EQ(verdicts_of(DecideBlock(rounded), pairs), verdicts_of(cpu.decide, pairs)) << name;
      ++checked;
    }
  }
  EXPECT_GE(checked, 2);
}

TEST_F(Toolchains, WhatCannotBeBuiltOrRunSaysWhy) {
  const std::string rows = write("rows.toml", R"([[toolchain]]
name = "no-compiler"
cxx = "no-such-compiler -O2"
needs = "a compiler"
[[toolchain]]
name = "no-emulator"
cxx = "c++ -O2"
run = "no-such-emulator"
[[toolchain]]
name = "no-language"
cc = "cc -O2"
[[toolchain]]
name = "no-flag"
cxx = "c++ -O2 -fno-such-flag"
[[toolchain]]
name = "no-object"
cxx = "true -O2"
[[toolchain]]
name = "no-program"
cxx = "c++ -O2"
run = "true"
)");
  open_published("separating_axes", rows);
  const std::pair<const char*, const char*> cases[] = {
      {"no-compiler", "no no-such-compiler (install a compiler)"},          {"no-emulator", "no no-such-emulator"},
      {"no-language", "the toolchain no-language has no compiler for C++"}, {"no-flag", "-fno-such-flag"},
      {"no-object", "made no object file: true -O2 -std=gnu++20"},          {"no-program", "the program ended"}};
  for (const auto& [name, why] : cases) {
    const Lane* lane = find_lane(std::string("separating_axes/f32/") + name);
    ASSERT_TRUE(lane) << name;
    EXPECT_FALSE(lane->decide) << name;
    EXPECT_NE(lane->evidence.find(why), std::string::npos) << lane->evidence;
    EXPECT_EQ(lane->evidence.find('\n'), std::string::npos) << lane->evidence;
  }
  EXPECT_TRUE(record({"separating_axes/f32/cpu"}).is_null());
}

// Changing a toolchain's runner changes the record.
TEST_F(Toolchains, TheirRunnerIsRecorded) {
  const std::string runner = write("runner", "#!/bin/sh\nexec \"$@\"\n");
  fs::permissions(runner, fs::perms::owner_all);
  const std::string rows =
      write("runs.toml", "[[toolchain]]\nname = \"runs\"\ncxx = \"c++ -O2\"\nrun = \"" + runner + " {}\"\n");
  open_published("moller_1997", rows);
  const auto recorded = [] { return record({"moller_1997/f32/runs"}).at(0).at("toolchains").at(0); };
  const nlohmann::ordered_json before = recorded();
  ASSERT_TRUE(before.contains("runner")) << before;
  EXPECT_EQ(recorded(), before);
  write("runner", "#!/bin/sh\nexport X=1\nexec \"$@\"\n");
  EXPECT_NE(recorded().at("runner"), before["runner"]);
}

// Foreign code in a toolchain's program fails only on its bad pairs, and its own output is not taken for an answer.
TEST_F(Toolchains, ProgramsThatFailLoseOnlyTheirPair) {
  Wanted wanted = parse_subject("fails=" + write("fails.cpp", R"(
#include <cstdio>
#include <cstdlib>
bool intersects(const float* a, const float* b) {
  std::printf("1\n");
  std::fflush(stdout);
  if (a[0] == 7) std::abort();
  for (volatile int i = 0; a[0] == 8;) i = 1;
  return a[0] < b[0];
}
)"));
  wanted.timeout = 0.3;
  wanted.toolchains = selected_toolchains("x86-gcc");
  open(wanted);
  const Lane& lane = *find_lane("fails/f32/x86-gcc");
  ASSERT_TRUE(lane.decide) << lane.evidence;
  std::vector<Pair> some(pairs.begin(), pairs.begin() + 200);
  some[20].a[0].x = 7;
  some[50].a[0].x = 8;
  const std::vector<Verdict> found = verdicts_of(lane.decide, some);
  for (std::size_t i = 0; i < some.size(); ++i) {
    const Verdict right = some[i].a[0].x < some[i].b[0].x ? Verdict::intersects : Verdict::disjoint;
    EXPECT_EQ(found[i], i == 20 ? Verdict::crashed : i == 50 ? Verdict::timed_out : right) << i;
  }
  const nlohmann::ordered_json rows = record({"fails/f32/x86-gcc"});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0]["toolchains"][0]["name"], "x86-gcc");
  EXPECT_FALSE(rows[0]["toolchains"][0]["build"].get<std::string>().empty());
  EXPECT_TRUE(open_recorded({{"subjects", rows}}).empty());
}

}  // namespace
}  // namespace graze::subjects
