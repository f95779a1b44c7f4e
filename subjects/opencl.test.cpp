// SPDX-License-Identifier: Apache-2.0
// Tests graze-subject-opencl on the device that it chooses. Without OpenCL these tests are skipped.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/lanes/verdicts.h"
#include "core/message_testing.h"
#include "strata/strata.h"
#include "subjects/code_hash.h"
#include "subjects/process.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExamples = GRAZE_SOURCE_DIR "/subjects/examples/";
constexpr std::uint64_t kPairsOfStratum = 4096;

fs::path runner() { return fs::read_symlink("/proc/self/exe").parent_path() / "graze-subject-opencl"; }

struct Said {
  std::string text;  // standard output and standard error, without the last newline
  int status;
};

// Runs graze-subject-opencl without asking it about pairs.
Said run(const std::string& arguments, const std::string& environment = "") {
  std::FILE* out = popen((environment + " '" + runner().string() + "' " + arguments + " 2>&1 </dev/null").c_str(), "r");
  Said said{"", -1};
  for (int c; (c = std::getc(out)) != EOF;) said.text += static_cast<char>(c);
  const int status = pclose(out);
  if (WIFEXITED(status)) said.status = WEXITSTATUS(status);
  if (said.text.ends_with('\n')) said.text.pop_back();
  return said;
}

struct OpenCl : testing::Test {
  static inline fs::path folder;
  static inline std::vector<Pair> pairs;  // of all strata

  static void SetUpTestSuite() {
    folder = fs::path(testing::TempDir()) / ("opencl-" + std::to_string(getpid()));
    fs::create_directories(folder);
    setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
    for (const strata::StratumInfo& stratum : strata::kStrata) {
      for (std::uint64_t i = 0; i < kPairsOfStratum; ++i) pairs.push_back(strata::generate(1, stratum.stratum, i));
    }
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }
  void SetUp() override {
    const Said said = run("--platforms");
    if (said.status == 127) GTEST_SKIP() << "built without opencl-c-headers";
    if (said.status == 3) GTEST_SKIP() << said.text;
    ASSERT_EQ(said.status, 0) << said.text;
  }

  static fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  static Code code(const fs::path& file, const std::string& function, const std::string& mode,
                   const std::string& scalar = "any") {
    Code code{"program", "'" + runner().string() + "' {} " + function + ' ' + scalar + ' ' + mode, "", "any", 5};
    code.content = std::make_shared<SealedCopy>(file.filename().string(), code_in(file));
    return code;
  }
  // The number of pairs on which the verdict differs from that of the algorithm's `cpu` lane.
  static std::size_t count_differing(const std::string& algorithm, Scalar scalar, const std::string& mode) {
    ForeignProcesses subject(code(std::string(kExamples) + "thesis.cl", algorithm, mode, std::string(name(scalar))),
                             scalar);
    const std::vector<Verdict> found = verdicts_of(subject, pairs);
    for (const Lane& lane : lanes()) {
      if (lane.id != id_of({algorithm, std::string(name(scalar)), "cpu", ""})) continue;
      const std::vector<Verdict> expected = verdicts_of(lane.decide, pairs);
      std::size_t differing = 0;
      for (std::size_t i = 0; i < pairs.size(); ++i) differing += found[i] != expected[i];
      return differing;
    }
    throw std::runtime_error("no lane of " + algorithm);
  }
};

TEST_F(OpenCl, TheThesisAlgorithmsWithoutContractionEqualTheirCpuLanes) {
  for (const char* algorithm : {"interval_overlap", "projected_sat"}) {
    for (const Scalar scalar : {Scalar::f32, Scalar::f64})
      EXPECT_EQ(count_differing(algorithm, scalar, "nofma"), 0u) << algorithm << ' ' << name(scalar);
  }
}

// A canary: pocl contracts within an expression, NVIDIA's compiler across statements. If these verdicts were equal, the
// test above would not show that `nofma` reaches the compiler. A device without FMA does not contract.
TEST_F(OpenCl, ByDefaultTheCompilerContracts) {
  if (run("--platforms").text.find("FMA yes") == std::string::npos) GTEST_SKIP() << "no device has FMA";
  EXPECT_GT(count_differing("interval_overlap", Scalar::f32, "default"), 0u);
  EXPECT_GT(count_differing("interval_overlap", Scalar::f64, "mad"), 0u);
  EXPECT_GT(count_differing("projected_sat", Scalar::f32, "fast"), 0u);
}

TEST_F(OpenCl, FunctionsOfOneTypeAnswerForItAlone) {
  const fs::path file = write("types.cl",
                              "int of_float(const float* a, const float* b) { return a[0] < b[0] ? 5 : -5; }\n"
                              "int of_double(const double* a, const double* b) { return a[0] < b[0]; }\n");
  const Description of_float = describe(code(file, "of_float", "default"));
  EXPECT_TRUE(of_float.f32 && !of_float.f64);
  const Description of_double = describe(code(file, "of_double", "default"));
  EXPECT_TRUE(!of_double.f32 && of_double.f64);
  ForeignProcesses subject(code(file, "of_float", "default"), Scalar::f32);
  const std::vector<Verdict> found = verdicts_of(subject, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    ASSERT_EQ(found[i], pairs[i].a[0].x < pairs[i].b[0].x ? Verdict::intersects : Verdict::declined) << i;
}

TEST_F(OpenCl, WhatAKernelPrintsIsNoAnswer) {
  const fs::path file = write("prints.cl", "int f(const REAL* a, const REAL* b) { printf(\"1\\n\"); return 0; }\n");
  ForeignProcesses subject(code(file, "f", "default"), Scalar::f32);
  const std::vector<Pair> few(pairs.begin(), pairs.begin() + 100);
  EXPECT_EQ(verdicts_of(subject, few), std::vector<Verdict>(few.size(), Verdict::disjoint));
}

// Compiling a function must not call it: this one would hang.
TEST_F(OpenCl, AFunctionThatFailsOnZerosCompiles) {
  const fs::path file = write("zeros.cl",
                              "int f(const REAL* a, const REAL* b) {\n"
                              "  int zero = 1;\n"
                              "  for (int i = 0; i < 9; ++i) zero &= a[i] == 0 && b[i] == 0;\n"
                              "  for (volatile int wait = zero; wait;) {}\n"
                              "  return a[0] < b[0] ? 5 : -5;\n"
                              "}\n");
  ForeignProcesses subject(code(file, "f", "default"), Scalar::f32);
  const std::vector<Pair> few(pairs.begin(), pairs.begin() + 100);
  const std::vector<Verdict> found = verdicts_of(subject, few);
  for (std::size_t i = 0; i < few.size(); ++i)
    ASSERT_EQ(found[i], few[i].a[0].x < few[i].b[0].x ? Verdict::intersects : Verdict::declined) << i;
}

TEST_F(OpenCl, MistakesAreToldInOneLine) {
  const std::string good = write("good.cl", "int f(const REAL* a, const REAL* b) { return 0; }\n");
  const std::string bad = write("bad.cl", "int f(const REAL* a, const REAL* b) {\n  return nonsense;\n}\n");
  const std::string other = write("other.cl", "bool f(const REAL* a, const REAL* b) { return true; }\n");
  const struct {
    std::string arguments, environment;
    int status;
    std::vector<std::string> names;
  } kCases[] = {
      {bad + " f any nofma", "", 4, {"bad.cl:2", "nonsense"}},
      {good + " missing any fast", "", 4, {"good.cl", "missing"}},
      {other + " f any default", "", 4, {"other.cl", "f"}},
      {"none.cl f any default", "", 1, {"none.cl", "No such file or directory"}},
      {good + " f f16 default", "", 2, {"f32|f64|any"}},
      {good + " 'f;' f32 default", "", 2, {"f;"}},
      {good + " f any default Atlantis", "", 3, {"Atlantis", "--platforms"}},
      {good + " f any default", "GRAZE_OPENCL=libnone.so.1", 3, {"libnone.so.1", "GRAZE_OPENCL"}},
      {good + " f any default", "GRAZE_OPENCL=libm.so.6", 3, {"libm.so.6", "clGetExtensionFunctionAddress"}},
  };
  for (const auto& c : kCases) {
    const Said said = run(c.arguments, c.environment);
    EXPECT_TRUE(names(said.text, c.names));
    EXPECT_EQ(said.status, c.status) << said.text;
  }
}

}  // namespace
}  // namespace graze::subjects
