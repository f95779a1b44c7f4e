// SPDX-License-Identifier: Apache-2.0
// Tests the contractions that hipcc makes, read from its assembly for AMD's GPUs. Without hipcc, tests that compile are
// skipped.
#include "subjects/hip.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/message_testing.h"
#include "subjects/published.h"
#include "subjects/subjects.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// Line 2 has a fused product within an expression, lines 3 and 4 have one across statements, and line 5 has a quotient.
constexpr const char* kSource = R"(template <class T> __device__ bool meets(const T* a, const T* b) {
  const T u = a[0] * b[0] + a[1];
  const T v = a[2] * b[2];
  const T w = v + u;
  const T q = w / a[3];
  return q > b[3];
}
)";

struct Hip : testing::Test {
  void SetUp() override {
    if (const std::string why = why_no_hip(); !why.empty()) GTEST_SKIP() << why;
    folder = fs::path(testing::TempDir()) / ("hip-" + std::to_string(getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override {
    if (!folder.empty()) fs::remove_all(folder);
  }
  fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  fs::path folder;
};

std::vector<int> lines_of(const std::vector<FusedLine>& plan) {
  std::vector<int> lines;
  for (const FusedLine& line : plan) lines.push_back(line.line);
  return lines;
}

TEST(HipAssembly, QuotientsAreNoContractions) {
  constexpr const char* kText =
      "\t.file\t1 \"/s\" \"k.hip\"\n\t.loc\t1 3 1\n\tv_fma_f32 v1, v2, v3, v4\n\tv_fmac_f32_e32 v1, v2, v3\n"
      "\tv_fma_f32 v1, v2, v3, v4\n\tv_fma_f32 v1, v2, v3, v4\n\tv_fma_f32 v1, v2, v3, v4\n"
      "\tv_div_fmas_f32 v1, v2, v3, v4\n\t.loc\t1 4 1\n\tv_mul_f32_e32 v1, v2, v3\n\tv_pk_fma_f32 v[0:1], v[2:3], "
      "v[4:5], v[6:7]\n\t.loc\t1 5 1\n\tv_fmac_f64_e32 v[0:1], v[2:3], v[4:5]\n\t.loc\t1 6 1\n\tv_fmaak_f32 v1, v2, "
      "v3, 0x402df854\n"
      "\tv_mad_u64_u32 v[0:1], s[0:1], v2, v3, v[4:5]\n";
  const std::vector<FusedLine> all = fused_lines(kText, "/s");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].place(), "k.hip:4");
  EXPECT_EQ(all[0].operations, "madd f32 x2");
  EXPECT_EQ(all[1].place(), "k.hip:5");
  EXPECT_EQ(lines_of(fused_lines(kText, "/s", "f64")), std::vector{5});
}

TEST_F(Hip, FusesWithinAndAcrossStatements) {
  const fs::path source = file("k.hip", kSource);
  for (const std::string_view target : kHipTargets) {
    const ContractionPlan plan = hip_plan(source, "meets", target, {});
    EXPECT_EQ(lines_of(plan.f32), (std::vector{2, 4})) << target;
    EXPECT_EQ(lines_of(plan.f64), (std::vector{2, 4})) << target;
    EXPECT_EQ(plan.f32.at(0).code, "const T u = a[0] * b[0] + a[1];");
    const ContractionPlan within = hip_plan(source, "meets", target, {"-ffp-contract=on"});
    EXPECT_EQ(lines_of(within.f32), std::vector{2}) << target;
    const ContractionPlan off = hip_plan(source, "meets", target, {"-ffp-contract=off"});
    EXPECT_TRUE(off.f32.empty() && off.f64.empty()) << target;
  }
}

TEST_F(Hip, CompilesSourcesWithItsOwnHeader) {
  const fs::path source =
      file("k.hip",
           fmt::format("#include <hip/hip_runtime.h>\n{}int main() {{\n  float* p = nullptr;\n  return hipMalloc(&p, "
                       "4);\n}}\n",
                       kSource));
  EXPECT_EQ(lines_of(hip_plan(source, "meets", "gfx90a", {}).f32), (std::vector{3, 5}));
}

TEST_F(Hip, SaysWhatDoesNotCompile) {
  const fs::path source = file("k.hip", "__device__ int meets(const float* a) { return undefined_name; }\n");
  const std::string error = error_of([&] { hip_plan(source, "meets", "gfx90a", {}); });
  EXPECT_NE(error.find("undefined_name"), std::string::npos) << error;
}

// hipcc fuses products in all published algorithms, and none without contraction.
TEST_F(Hip, ReadsThePublishedAlgorithms) {
  std::size_t read = 0;
  for (const Lane& lane : published_lanes()) {
    if (lane.variant != Variant::cpu || lane.scalar != Scalar::f32) continue;
    const fs::path source = published_source(lane);
    const ContractionPlan plan = hip_plan(source, kPublishedFunction, "gfx90a", {});
    EXPECT_GE(plan.f32.size(), 2u) << lane.id;
    EXPECT_GE(plan.f64.size(), 2u) << lane.id;
    const ContractionPlan off = hip_plan(source, kPublishedFunction, "gfx90a", {"-ffp-contract=off"});
    EXPECT_TRUE(off.f32.empty() && off.f64.empty()) << lane.id;
    ++read;
  }
  EXPECT_EQ(read, 5u);
}

TEST(HipSubject, IsCompiledOnly) {
  const fs::path source = fs::path(testing::TempDir()) / ("only-" + std::to_string(getpid()) + ".hip");
  std::ofstream(source) << kSource;
  const std::string error = error_of([&] { open({"mine", source.string(), {}}); });
  EXPECT_NE(error.find("graze toolchain hip --subject mine="), std::string::npos) << error;
  fs::remove(source);
}

TEST(NvidiaPlan, IsThatOfTheTwin) {
  const Lane* fused = find_lane("interval_overlap/f32/cuda-fma");
  ASSERT_NE(fused, nullptr);
  const std::vector<FusedLine> plan = nvidia_plan(*fused, GRAZE_SOURCE_DIR);
  ASSERT_GT(plan.size(), 3u);
  for (const FusedLine& line : plan) EXPECT_FALSE(line.code.empty()) << line.place();
  EXPECT_TRUE(nvidia_plan(*find_lane("interval_overlap/f32/cuda-nofma"), GRAZE_SOURCE_DIR).empty());
}

}  // namespace
}  // namespace graze::subjects
