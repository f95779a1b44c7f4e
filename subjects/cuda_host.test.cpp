// SPDX-License-Identifier: Apache-2.0
// Tests the host lanes of CUDA sources whose function is __host__ __device__.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "strata/strata.h"
#include "subjects/rebuilt.h"
#include "subjects/source_build.h"
#include "subjects/subjects.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// If one product of the area is fused, the two products no longer cancel exactly.
constexpr char kBoth[] = R"(#include <cuda_runtime.h>
#ifdef __CUDACC__
#define HD __device__ __forceinline__ __host__
#endif
HD float area(float3 p, float3 q) {
  return p.x * p.y - q.x * q.y;
}
__global__ void kernel(const float* a, bool* out) { out[threadIdx.x] = a[blockIdx.x * blockDim.x + threadIdx.x] > 0; }
template <class Number> HD bool meet(const Number a[9], const Number b[9]) {
  return area(make_float3(a[0], a[1], a[2]), make_float3(a[3], a[4], a[5])) != 0 && LIMIT < b[8];
}
)";

struct CudaHost : testing::Test {
  CudaHost() {
    fs::create_directories(folder);
    setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
  }
  ~CudaHost() override { fs::remove_all(folder); }

  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
  // Opens the subject.   Returns: false without NVRTC.
  bool opens(const std::string& subject, std::vector<std::string> flags = {}, std::vector<Toolchain> toolchains = {}) {
    try {
      Wanted wanted = parse_subject(subject);
      wanted.flags = std::move(flags);
      wanted.timeout = 60;
      wanted.toolchains = std::move(toolchains);
      open(wanted);
      return true;
    } catch (const std::runtime_error& error) {
      if (std::string(error.what()).find("cannot find NVRTC") == std::string::npos) throw;
      return false;
    }
  }

  fs::path folder = fs::temp_directory_path() / ("graze-cuda-host-" + std::to_string(getpid()));
};

TEST_F(CudaHost, HasTheLanesOfACppSource) {
  write("part.h", "#define LIMIT -1e30f\n");
  const std::string file = write("both.cu", "#include \"part.h\"\n" + std::string(kBoth));
  if (!opens("hd=" + file + ":meet", {"-lineinfo"})) GTEST_SKIP() << "no NVRTC";
  const Lane *cpu = find_lane("hd/f32/cpu"), *fused_cpu = find_lane("hd/f32/cpu-fma"),
             *rounded = find_lane("hd/f32/cuda-nofma"), *fused = find_lane("hd/f32/cuda-fma");
  ASSERT_TRUE(cpu && fused_cpu && rounded && fused && cpu->decide && rounded->decide && fused->decide);
  EXPECT_FALSE(find_lane("hd/f64/cpu"));
  int differ = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    Pair pair = strata::generate(3, strata::Stratum::uniform, i);
    if (i % 2 == 0) pair.a[0] = pair.a[1] = {pair.a[0].x, pair.a[0].x, 0};
    const Verdict of_cpu = decide_one(cpu->decide, pair);
    EXPECT_EQ(of_cpu, decide_one(rounded->decide, pair)) << i;
    EXPECT_EQ(of_cpu == Verdict::disjoint, i % 2 == 0) << i;
    const Verdict of_fused = decide_one(fused->decide, pair);
    if (fused_cpu->decide && runs_on_this_cpu(*fused_cpu)) {
      EXPECT_EQ(decide_one(fused_cpu->decide, pair), of_fused) << i;
    }
    differ += of_fused != of_cpu;
  }
  EXPECT_GT(differ, 100);
  EXPECT_TRUE(has_source_as_built(*cpu));
  EXPECT_FALSE(has_source_as_built(*fused));

  // A record names the host's builds if host lanes ran. Older records name no such builds, but can still be opened.
  EXPECT_FALSE(record({"hd/f32/cuda-fma"})[0].contains("host"));
  Json spec{{"subjects", record({"hd/f32/cpu", "hd/f32/cuda-fma"})}};
  EXPECT_GE(spec["subjects"][0].at("host").at("builds").size(), 1u) << spec;
  EXPECT_TRUE(open_recorded(spec).empty());
  spec["subjects"][0]["host"]["builds"][0] = "0123456789abcdef";
  EXPECT_EQ(open_recorded(spec, false, Changed::used).size(), 1u);
  EXPECT_THROW(open_recorded(spec), std::runtime_error);
  spec["subjects"][0].erase("host");
  EXPECT_TRUE(open_recorded(spec).empty());
}

TEST_F(CudaHost, TakesToolchainsToo) {
  write("part.h", "#define LIMIT -1e30f\n");
  const std::string file = write("both.cu", "#include \"part.h\"\n" + std::string(kBoth));
  if (!opens("tool=" + file + ":meet", {}, selected_toolchains("x86-gcc"))) GTEST_SKIP() << "no NVRTC";
  const Lane *lane = find_lane("tool/f32/x86-gcc"), *cpu = find_lane("tool/f32/cpu");
  ASSERT_TRUE(lane && cpu);
  if (!lane->decide) GTEST_SKIP() << lane->evidence;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Pair pair = strata::generate(4, strata::Stratum::uniform, i);
    EXPECT_EQ(decide_one(lane->decide, pair), decide_one(cpu->decide, pair)) << i;
  }
}

TEST_F(CudaHost, DeviceFunctionsHaveNone) {
  const std::string file = write("device.cu",
                                 "// __host__ __device__ bool meet(const float*, const float*);\n"
                                 "__host__ __device__ bool helper(const float* a) { return a[0] > 0; }\n"
                                 "__device__ bool meet(const float a[9], const float b[9]) { return helper(a); }\n");
  if (!opens("device=" + file + ":meet")) GTEST_SKIP() << "no NVRTC";
  EXPECT_TRUE(find_lane("device/f32/cuda-fma"));
  EXPECT_FALSE(find_lane("device/f32/cpu"));
  EXPECT_FALSE(record({"device/f32/cuda-fma"})[0].contains("host"));
}

TEST_F(CudaHost, WhatDoesNotCompileThereSaysSo) {
  const std::string file = write("intrinsic.cu",
                                 "__host__ __device__ bool meet(const float a[9], const float b[9]) {\n"
                                 "  return __fmul_rn(a[0], a[1]) > b[0];\n}\n");
  if (!opens("intrinsic=" + file + ":meet")) GTEST_SKIP() << "no NVRTC";
  const Lane *cpu = find_lane("intrinsic/f32/cpu"), *fused = find_lane("intrinsic/f32/cuda-fma");
  ASSERT_TRUE(cpu && fused);
  EXPECT_FALSE(cpu->decide);
  EXPECT_TRUE(fused->decide);
  EXPECT_NE(cpu->evidence.find("intrinsic.cu:2"), std::string::npos) << cpu->evidence;
  EXPECT_NE(cpu->evidence.find("__fmul_rn"), std::string::npos) << cpu->evidence;
  EXPECT_EQ(cpu->evidence.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace graze::subjects
