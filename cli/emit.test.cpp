// SPDX-License-Identifier: Apache-2.0
// `graze repro --emit`: compiles and runs each kind of snippet with the command in its first comment.
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

struct EmitCase {
  const char* name;
  const char* pair;  // 18 numbers
  const char* cpu;   // a wrong CPU lane
  const char* cuda;  // a wrong CUDA lane
};

std::ostream& operator<<(std::ostream& out, const EmitCase& c) { return out << c.name; }

// Wrong lanes are named explicitly, so that the test fails if a case is no longer wrong.
constexpr EmitCase kCases[] = {
    // The thesis's figure 3.4.
    {"Plain", "0 0 0 4 0 0 0 4 0  1 2 1 11 0 -1 9 0 -1", "projected_sat/f32/cpu", "projected_sat/f64/cuda-fma"},
    // The same pair with every zero negative.
    {"NegativeZero", "-0 -0 -0 4 -0 -0 -0 4 -0  1 2 1 11 -0 -1 9 -0 -1", "projected_sat/f64/cpu",
     "projected_sat/f32/cuda-nofma"},
    // Two segments on parallel lines.
    {"Degenerate", "0 0 0 4 0 0 2 0 0  1 0 1 1 0 4 1 0 2", "separating_axes/f64/cpu",
     "interval_overlap/f32/cuda-nofma"},
    // The end of one segment lies on the other segment.
    {"DegenerateContact", "0 0 0 4 0 0 2 0 0  1 0 0 1 0 4 1 0 2", "moller_1997/f32/cpu", "moller_1997/f32/cuda-fma"},
    // Every product underflows.
    {"Subnormal",
     "0x1p-149 0 0 0x1p-140 0 0 0 0x1p-140 0  0x1p-145 0x1p-145 0x1p-148 0x1p-145 0x1p-144 0x1p-140 0x1p-144 0x1p-145 "
     "0x1p-140",
     "guigue_devillers_2003/f32/cpu", "separating_axes/f32/cuda-nofma"},
    // Every product overflows.
    {"Huge", "0 0 0 3e38 0 0 0 3e38 0  1e38 1e38 1e30 1e38 1e38 3e38 2e38 1e38 3e38", "moller_1997/f32/cpu",
     "separating_axes/f32/cuda-fma"},
    // The README's pair: right without contraction, on host and device.
    {"ContractionOnly", "0.1 0.2 0.3 0.4 0.9 0.2 0.7 0.1 0.6  0.1 0.2 0.3 0.5 0.5 0.9 -0.3 0.8 0.4",
     "guigue_devillers_2003/f64/cpu-fma", "guigue_devillers_2003/f64/cuda-fma"},
};

class Emit : public testing::TestWithParam<EmitCase> {
 protected:
  Shell shell{std::string("emit-") + GetParam().name};

  void SetUp() override { std::ofstream(shell.folder / "case.pairs") << GetParam().pair << '\n'; }

  // Emits to `file`, then runs the command in its first comment.
  Ran run(const std::string& kind, const std::string& file, const std::string& lane = "") {
    const std::string lanes = lane.empty() ? "" : " --lanes '" + lane + "'";
    shell.done("graze repro case.pairs --emit " + kind + lanes + " > " + file);
    std::istringstream text(shell.file(file));
    std::string comment, command;
    text >> comment;
    std::getline(text, command);
#ifdef GRAZE_NVCC_DIR
    return shell("PATH=$PATH:" GRAZE_NVCC_DIR "\n" + command);
#else
    return shell(command);
#endif
  }

  // Whether this build contracts, which needs optimisation and a processor with fused multiply-adds.
  bool contracts() const {
#ifdef NDEBUG
    return shell("graze lanes | grep -q '/cpu-fma *available'").status == 0;
#else
    return false;
#endif
  }

  // Expects "algorithm/scalar: X; truth: Y" with opposite X and Y, and the status of a failed check.
  static void expect_wrong(const Ran& ran, const std::string& lane) {
    const std::string what = lane.substr(0, lane.rfind('/'));
    EXPECT_EQ(ran.status, 1) << ran.out << ran.err;
    EXPECT_TRUE(ran.out == what + ": disjoint; truth: intersects\n" ||
                ran.out == what + ": intersects; truth: disjoint\n")
        << ran.out << ran.err;
  }
};

TEST_P(Emit, CppShowsTheWrongVerdict) {
  const std::string lane = GetParam().cpu;
  if (lane.ends_with("-fma") && !contracts()) GTEST_SKIP() << "this build does not contract";
  expect_wrong(run("cpp", "case.cpp", lane), lane);
}

TEST_P(Emit, GtestFails) {
  if (std::string(GetParam().cpu).ends_with("-fma") && !contracts()) GTEST_SKIP() << "this build does not contract";
  const Ran ran = run("gtest", "case.cpp", GetParam().cpu);
  EXPECT_EQ(ran.status, 1) << ran.err;
  EXPECT_TRUE(has(ran.out, {" 1 FAILED TEST"}));
}

TEST_P(Emit, CudaShowsTheWrongVerdict) {
#ifndef GRAZE_NVCC_DIR
  GTEST_SKIP() << "built without nvcc";
#endif
  const Ran ran = run("cuda", "case.cu", GetParam().cuda);
  ASSERT_TRUE(std::filesystem::exists(shell.folder / "case")) << ran.err;
  if (shell("graze lanes | grep -q 'available (device)'").status != 0)
    GTEST_SKIP() << "compiled, not run: no CUDA device";
  expect_wrong(ran, GetParam().cuda);
}

TEST_P(Emit, CgalAndPythonProveTheTruth) {
  const Ran cgal = run("cgal", "case.cpp");
  EXPECT_EQ(cgal.status, 0) << cgal.out << cgal.err;
  EXPECT_TRUE(cgal.out == "truth: disjoint; Graze: disjoint\n" || cgal.out == "truth: intersects; Graze: intersects\n");
  if (shell("command -v python3").status != 0) GTEST_SKIP() << "no python3";
  const Ran python = run("python", "case.py");
  EXPECT_EQ(python.status, 0) << python.out << python.err;
  EXPECT_TRUE(python.out.ends_with(cgal.out)) << python.out << cgal.out;
}

// The decimals of the OBJ file, read back as a pair, have the case's bits.
TEST_P(Emit, ObjHoldsTheSameBits) {
  const Ran emitted = shell("graze repro case.pairs --emit obj > case.obj; grep -c '^[of] ' case.obj");
  EXPECT_EQ(emitted.out, "4\n");
  const std::string bits = " | head -n 7 | tail -n 6";
  shell.done("graze check case.pairs --truth-only" + bits +
             " > a; sed -n 's/^v //p' case.obj | tr '\\n' ' ' | graze check - --truth-only" + bits +
             " > b; test -s a && cmp a b");
}

INSTANTIATE_TEST_SUITE_P(cli, Emit, testing::ValuesIn(kCases),
                         [](const testing::TestParamInfo<EmitCase>& test) { return test.param.name; });

TEST(EmitLane, IsOfTheRecordedSignature) {
  const Shell shell("emit-lane");
  const std::string pair = "echo '0 0 0 4 0 0 2 0 0  1 0 1 1 0 4 1 0 2";
  const auto shown = [&](const std::string& fields) {
    return shell(pair + fields + "' > p; graze repro p --emit cpp | sed -n 's/.*on which \\(.*\\) is wrong.*/\\1/p'")
        .out;
  };
  EXPECT_EQ(shown(""), "projected_sat/f32/cpu\n");
  EXPECT_EQ(shown(" | signature=none/11/skew/+2^21/separating_axes:++++++++"), "separating_axes/f32/cpu\n");
  // moller_1997 is right on the pair, so another lane is shown.
  EXPECT_EQ(shown(" | signature=none/11/skew/+2^21/moller_1997:++++++++"), "projected_sat/f32/cpu\n");
}

// A snippet is compiled with its lane's flags.
TEST(EmitFlags, AreThoseOfTheLane) {
  const Shell shell("emit-flags");
  shell("echo '0 0 0 4 0 0 0 4 0  1 2 1 11 0 -1 9 0 -1' > p");
  const auto first_line = [&](const std::string& what) {
    return shell("graze repro p --emit " + what + " | head -n 1").out;
  };
  EXPECT_TRUE(has(first_line("cpp --lanes '*/f32/cpu'"), {"-ffp-contract=off"}));
  EXPECT_TRUE(has(first_line("cpp --lanes '*/f32/cpu-fma'"), {"-ffp-contract=fast"}));
  EXPECT_TRUE(has(first_line("cuda --lanes '*/f32/cuda-nofma'"), {"-fmad=false"}));
  EXPECT_FALSE(has(first_line("cuda --lanes '*/f32/cuda-fma'"), {"fmad"}));
}

// Needs no device: the contraction rules were verified on one, and must give a snippet's kernel as many fused
// operations as its lane's kernel has.
TEST(EmitCuda, ContractsAsItsLaneDoes) {
#ifndef GRAZE_NVCC_DIR
  GTEST_SKIP() << "built without nvcc";
#else
  const Shell shell("emit-cuda");
  const std::string explicit_ptx = "graze_twin_generator " GRAZE_LANE_PTX " --explicit lanes.ptx && ";
  // Pairs of segments on which each algorithm has a wrong lane, on the host and on the device.
  shell("printf '0 0 0 4 0 0 2 0 0 1 0 1 1 0 4 1 0 2\\n0 0 0 4 0 0 2 0 0 1 0 0 1 0 4 1 0 2\\n' > p");
  const std::string ids = shell("graze lanes | sed -n 's|^  \\([a-z0-9_]*\\)/f32/cpu .*|\\1|p' | grep -v exact").out;
  std::istringstream algorithms(ids);
  int index = 0;
  for (std::string id; algorithms >> id; ++index) {
    for (const std::string scalar : {"f32", "f64"}) {
      const std::string kernel = "decide_pairsILi" + std::to_string(index) + "E" + (scalar == "f32" ? 'f' : 'd');
      const Ran counts = shell(explicit_ptx + "graze repro p --emit cuda --lanes '" + id + "/" + scalar +
                               "/cuda-fma' > case.cu && PATH=$PATH:" GRAZE_NVCC_DIR
                               " nvcc -std=c++20 -O3 -arch=compute_75 -ptx -lineinfo case.cu -o case.ptx && "
                               "graze_twin_generator case.ptx --explicit own.ptx && grep -c fma.rn own.ptx && "
                               "sed -n '/entry.*" +
                               kernel + "/,/^}/p' lanes.ptx | grep -c fma.rn");
      int own = 0, lane = 0;
      std::istringstream(counts.out) >> own >> lane;
      EXPECT_GT(own, 40) << id << scalar << counts.err;
      EXPECT_EQ(own, lane) << id << '/' << scalar;
    }
  }
  EXPECT_GE(index, 5) << ids;
#endif
}

TEST(EmitErrors, SayWhatIsMissing) {
  const Shell shell("emit-errors");
  const auto expect = [&](const std::string& command, int status, const std::vector<std::string>& words) {
    const Ran ran = shell(command);
    EXPECT_EQ(ran.status, status) << command;
    EXPECT_EQ(ran.out, "");
    ASSERT_TRUE(ran.err.ends_with('\n')) << ran.err;
    EXPECT_TRUE(names(ran.err.substr(0, ran.err.size() - 1), words));
  };
  const std::string easy = "echo '0 0 0 4 0 0 0 4 0  0 0 9 4 0 9 0 4 9' > easy; graze repro easy --emit ";
  expect(easy + "cpp", 1, {"easy", "CPU lanes"});
  expect(easy + "cuda", 1, {"easy", "CUDA lanes"});
  expect(easy + "cpp --lanes '*/cuda-*fma'", 1, {"easy", "CPU lanes"});
  expect(easy + "fortran", 2, {"fortran"});
  expect("echo 'nan 0 0 4 0 0 0 4 0  0 0 9 4 0 9 0 4 9' > n; graze repro n --emit obj", 1, {"n", "finite coordinates"});
  EXPECT_TRUE(has(shell(easy + "python").out, {"Graze: disjoint"}));  // needs no wrong lane
}

}  // namespace
}  // namespace graze::cli
