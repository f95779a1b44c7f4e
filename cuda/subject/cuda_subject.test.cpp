// SPDX-License-Identifier: Apache-2.0
// Tests builds of users' CUDA files, their error messages, and the cache of reproducible builds.
#include "cuda/subject/cuda_subject.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/programs/run_program.h"
#include "cuda/subject/machine_code.h"
#include "cuda/subject/nvrtc.h"
#include "cuda/twin/twin_library.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

class CudaSubject : public testing::Test {
 protected:
  CudaSubject() : scratch_(fs::temp_directory_path()) {}
  void SetUp() override {
    try {
      Nvrtc::get();
    } catch (const std::runtime_error& error) {
      GTEST_SKIP() << error.what();
    }
  }

  fs::path file(const std::string& text) const {
    const fs::path path = scratch_.path() / "mine.cu";
    std::ofstream(path) << text;
    return path;
  }
  std::vector<CudaBuild> build(const std::string& text, const std::string& function = "intersects",
                               const std::vector<std::string>& flags = {}) const {
    return build_cuda_subject(file(text), function, flags, scratch_.path() / "cache");
  }
  // The error message about the source text, with the folder removed from file names.
  std::string complaint(const std::string& text, const std::string& function = "intersects") const {
    try {
      build(text, function);
      return "";
    } catch (const UsageError& error) {
      std::string said = error.what();
      const std::string folder = scratch_.path().string() + "/";
      for (auto at = said.find(folder); at != said.npos; at = said.find(folder)) said.erase(at, folder.size());
      return said;
    }
  }

  Scratch scratch_;
};

constexpr char kSimple[] =
    "__device__ bool intersects(const float a[9], const float b[9]) { return a[0] * b[0] + a[1] > b[1]; }\n";

TEST_F(CudaSubject, HasFourBuilds) {
  const std::vector<CudaBuild> builds = build(kSimple);
  ASSERT_EQ(builds.size(), 4u);
  const Variant variants[] = {Variant::cuda_nofma, Variant::cuda_fma, Variant::cuda_fast, Variant::cuda_ftz};
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(builds[v].variant, variants[v]);
    EXPECT_EQ(builds[v].scalar, Scalar::f32);
    EXPECT_EQ(builds[v].why_no_twin, "");
    EXPECT_EQ(builds[v].hash.size(), 16u);
    EXPECT_EQ(builds[v].toolkit.substr(0, 2), Nvrtc::get().version().substr(0, 2));
  }
  EXPECT_NE(builds[0].hash, builds[1].hash);
  EXPECT_NE(builds[1].hash, builds[3].hash);
  const TwinLibrary contracted(builds[1].twin, Scalar::f32);
  ASSERT_EQ(contracted.sites().size(), 1u);
  EXPECT_EQ(contracted.sites()[0].at.line, 1);
  EXPECT_THROW(TwinLibrary(builds[1].twin, Scalar::f64), std::runtime_error);
}

TEST_F(CudaSubject, FlushesSubnormalsInItsVariantOnly) {
  const auto builds = build(
      "__device__ int intersects(const float a[9], const float b[9]) { return a[0] * b[0] > 0 ? 1 : a[1] != 0 ? -1 : "
      "0; }");
  const Pair pairs[] = {{{{0x1p-70f, 0, 0}}, {{0x1p-70f, 0, 0}}}, {{{0, 1, 0}}, {}}};
  for (const CudaBuild& one : builds) {
    std::int8_t answers[2] = {};
    TwinLibrary(one.twin, one.scalar).decide(pairs, answers);
    EXPECT_EQ(answers[0], one.variant == Variant::cuda_nofma || one.variant == Variant::cuda_fma) << name(one.variant);
    EXPECT_EQ(answers[1], -1);
  }
}

TEST_F(CudaSubject, AKernelThatEndsEarlyWritesNoAnswer) {
  const auto builds = build(
      "__device__ int intersects(const float a[9], const float b[9]) { if (a[0] > 1) asm volatile(\"exit;\"); return "
      "b[0] > 1; }");
  ASSERT_EQ(builds[0].why_no_twin, "");
  const Pair pairs[] = {{{{2, 0, 0}}, {{2, 0, 0}}}, {{}, {{2, 0, 0}}}};
  std::int8_t answers[2] = {7, 7};
  TwinLibrary(builds[0].twin, builds[0].scalar).decide(pairs, answers);
  EXPECT_EQ(answers[0], 7);
  EXPECT_EQ(answers[1], 1);
}

TEST_F(CudaSubject, KnowsFloatAndDoubleAndNames) {
  EXPECT_EQ(build("__device__ bool f(const double* a, const double* b) { return a[0] < b[0]; }", "f")[0].scalar,
            Scalar::f64);
  EXPECT_EQ(
      build("namespace n { template <class T> __device__ bool f(const T* a, const T* b) { return a[0] < b[0]; } }",
            "n::f")[0]
          .scalar,
      Scalar::f32);
  EXPECT_EQ(build("__device__ bool g(const float (&a)[9], const float (&b)[9]) { return a[8] < b[8]; }", "g")[0].scalar,
            Scalar::f32);
}

TEST_F(CudaSubject, InDoubleDecidesDoublesAsTheyAre) {
  const std::string rounds = "__device__ bool f(const Real a[9], const Real b[9]) { return a[0] * a[1] - b[0] > 0; }";
  const DoublePair doubles[] = {{{{1 + 0x1p-52, 1 + 0x1p-52, 0}}, {{1 + 0x1p-51, 0, 0}}},
                                {{{1 + 0x1p-51, 1, 0}}, {{1, 0, 0}}}};
  const auto in_double = build("using Real = double;\n" + rounds, "f");
  for (const CudaBuild& one : {in_double[0], in_double[1]}) {
    const bool fuses = one.variant == Variant::cuda_fma;
    const TwinLibrary twin(one.twin, Scalar::f64);
    std::int8_t answers[2] = {};
    twin.decide(std::span(doubles), answers);
    EXPECT_EQ(answers[0], fuses);  // a rounded product equals the other operand
    EXPECT_EQ(answers[1], 1);
    const std::uint64_t all = ~std::uint64_t{0}, none = 0;
    EXPECT_EQ(twin.decide_fusing(doubles[0], {&all, 1}), fuses);
    EXPECT_EQ(twin.decide_fusing(doubles[0], {&none, 1}), 0);
    const Pair stored[] = {stored_in_float32(doubles[0]), stored_in_float32(doubles[1])};
    twin.decide(std::span(stored), answers);
    EXPECT_EQ(answers[1], 0);
  }
  const auto in_float = build("using Real = float;\n" + rounds, "f");
  const TwinLibrary twin(in_float[0].twin, Scalar::f32);
  const std::uint64_t none = 0;
  std::int8_t answers[2] = {};
  EXPECT_EQ(twin.decide_fusing(doubles[1], {&none, 1}), 0);  // float32 rounds both operands to 1
  EXPECT_THROW(twin.decide(std::span(doubles), answers), std::logic_error);
}

TEST_F(CudaSubject, SaysWhatItFound) {
  const std::string expected =
      "mine.cu: expected __device__ bool intersects(const float a[9], const float b[9]), or int, or with double; ";
  EXPECT_EQ(complaint("__device__ bool other(const float* a) { return a[0] > 0; }"),
            expected + "found no function of that name");
  EXPECT_EQ(complaint("__device__ bool intersects(const float* a) { return a[0] > 0; }"),
            expected + "found bool (*)(const float *)");
  EXPECT_EQ(complaint("\n__device__ bool intersects(const float a[9], const float b[9]) { return c; }"),
            "mine.cu:2: identifier \"c\" is undefined");
  EXPECT_EQ(complaint("#include \"missing.h\"\n").substr(0, 10), "mine.cu:1:");
  EXPECT_EQ(complaint(kSimple, "f(1)"), "mine.cu: expected the name of a function, found 'f(1)'");
  EXPECT_THROW(build_cuda_subject(scratch_.path() / "none.cu", "f", {}, scratch_.path()), UsageError);
}

TEST_F(CudaSubject, TakesHeadersAndFlags) {
  EXPECT_EQ(complaint("#include <math.h>\n#include <cmath>\n#include <cfloat>\n#include <cstdint>\n#include "
                      "<stdio.h>\n#include <assert.h>\n"
                      "#include <stdbool.h>\n#include <limits>\n#include <algorithm>\n#include <cuda_runtime.h>\n"
                      "__device__ bool intersects(const float a[9], const float b[9]) {\n  assert(a[0] == 0);\n"
                      "  return std::fabs(a[0]) < std::max(FLT_EPSILON, std::numeric_limits<float>::infinity()) && "
                      "a[2] < INFINITY && std::sqrt(b[0]) > (uint8_t)a[1];\n}\n"
                      "int main() { return 0; }\n"),
            "");
  EXPECT_EQ(build("__device__ bool intersects(const float a[9], const float b[9]) { return a[0] < LIMIT; }",
                  "intersects", {"-DLIMIT=3"})
                .size(),
            4u);
}

TEST_F(CudaSubject, HasTwinsOfWhatPeopleWrite) {
  const auto why = [&](const std::string& body, const std::string& before = "") {
    const auto builds =
        build(before + "\n__device__ bool intersects(const float a[9], const float b[9]) { " + body + " }");
    return builds[0].why_no_twin + builds[1].why_no_twin + builds[3].why_no_twin;
  };
  // The file has vector types, another kernel and a host function.
  EXPECT_EQ(
      why("const float3 c = cross(make_float3(a[0], a[1], a[2]), make_float3(b[0], b[1], b[2])); return c.x > c.y * "
          "c.z;",
          "static __device__ __forceinline__ float3 cross(float3 u, float3 v) { return make_float3(u.y * v.z - u.z * "
          "v.y, "
          "u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x); }\n__global__ void other(float* x) { x[0] = __sinf(x[1]); }\n"
          "int main() { return 0; }"),
      "");
  // The toolkit implements these math functions in full precision, with tables and loops.
  EXPECT_EQ(why("return cosf(a[0]) < b[0] && atan2f(a[1], b[1]) < 1 && sinf(a[2]) < hypotf(b[2], 1);"), "");
  EXPECT_EQ(why("return nextafterf(a[3], 1) < lroundf(b[3]) && fdimf(a[0], b[0]) < scalbnf(b[1], 3);"), "");
  // Other math functions consist of approximate operations.
  EXPECT_NE(why("return fmodf(a[0], b[0]) < a[1];").find("cannot be replayed: rcp.approx.ftz.f32"), std::string::npos);
  EXPECT_NE(why("return cbrtf(a[2]) < b[2];").find("cannot be replayed: lg2.approx.f32"), std::string::npos);
  EXPECT_NE(why("return pow((double)a[0], 2.0) < b[0];").find("cannot be replayed: rcp.approx.ftz.f64"),
            std::string::npos);
  // Inline assembly may have a scope.
  EXPECT_EQ(
      why("int is; asm(\"{ .reg .pred q; setp.gt.f32 q, %1, %2; selp.s32 %0, 1, 0, q; }\" : \"=r\"(is) : \"f\"(a[0]), "
          "\"f\"(b[0])); return is;"),
      "");
  // The function uses a union, and sorts an array of structs.
  EXPECT_EQ(why("E e[3]; for (int i = 0; i < 3; ++i) { e[i].at.f = a[3 * i] * b[i]; e[i].i = i; }\n"
                "for (int i = 0; i < 2; ++i) for (int j = 0; j < 2 - i; ++j) if (e[j + 1].at.f < e[j].at.f) { E t = "
                "e[j]; e[j] = e[j + 1]; "
                "e[j + 1] = t; }\nreturn e[0].i == 1 && (e[2].at.u & 0x80);",
                "struct E { union { float f; unsigned u; } at; int i; };"),
            "");
}

TEST_F(CudaSubject, RefusesByName) {
  const auto why = [&](const std::string& body, const std::string& before = "") {
    return build(before + "__device__ bool intersects(const float a[9], const float b[9]) { " + body + " }")[0]
        .why_no_twin;
  };
  EXPECT_NE(why("return __fdividef(a[0], b[0]) > 1;").find("cannot be replayed: div.approx.f32"), std::string::npos);
  EXPECT_NE(why("count = 1; return a[0] > b[0];", "__device__ int count;\n")
                .find("a write to global memory cannot be replayed"),
            std::string::npos);
  EXPECT_NE(why("printf(\"%f\", a[0]); return a[0] > b[0];").find("function in another file cannot be replayed"),
            std::string::npos);
}

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(CudaSubject, KeepsWhatItBuilds) {
  const auto first = build(kSimple);
  const auto changed = fs::last_write_time(first[1].twin);
  const auto second = build(kSimple);
  EXPECT_EQ(second[1].twin, first[1].twin);
  EXPECT_EQ(second[1].hash, first[1].hash);
  EXPECT_EQ(second[1].ptx, first[1].ptx);
  EXPECT_EQ(fs::last_write_time(first[1].twin), changed);
  const auto elsewhere = build_cuda_subject(file(kSimple), "intersects", {}, scratch_.path() / "other");
  EXPECT_EQ(content(elsewhere[1].twin), content(first[1].twin));
  for (const auto& entry : fs::directory_iterator(scratch_.path() / "cache"))
    EXPECT_TRUE(entry.path().filename().string().starts_with("twin-") ||
                entry.path().filename().string().starts_with("code-"));
  // The next build replaces a damaged file in the cache.
  fs::resize_file(first[1].twin, fs::file_size(first[1].twin) - 100);
  EXPECT_EQ(build(kSimple)[1].twin, first[1].twin);
  EXPECT_EQ(content(elsewhere[1].twin), content(first[1].twin));
  // Comments do not change a proof's hash.
  EXPECT_EQ(build(std::string("// a comment\n") + kSimple)[1].hash, first[1].hash);
}

TEST_F(CudaSubject, SeesWrongMachineCode) {
  const fs::path ptxas = find_ptxas(Nvrtc::get().library());
  if (ptxas.empty()) GTEST_SKIP() << "no ptxas";
  const auto builds = build(kSimple);
  EXPECT_TRUE(builds[1].machine_code_identical);
  EXPECT_NE(assemble(ptxas, builds[0].ptx, scratch_.path()), assemble(ptxas, builds[1].ptx, scratch_.path()));
  EXPECT_THROW(assemble(ptxas, "nonsense", scratch_.path()), std::runtime_error);
}

}  // namespace
}  // namespace graze::cuda
