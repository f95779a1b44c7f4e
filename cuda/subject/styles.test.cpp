// SPDX-License-Identifier: Apache-2.0
// Tests of twenty predicates in different styles (cuda/subject/styles). Each predicate has a twin with the same
// verdicts as its source under the host's compiler, or graze refuses it and tells why. Skipped without NVRTC.
#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "core/error.h"
#include "core/programs/run_program.h"
#include "cuda/subject/cuda_subject.h"
#include "cuda/subject/machine_code.h"
#include "cuda/subject/nvrtc.h"
#include "cuda/twin/twin_library.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

const fs::path kStyles = fs::path(GRAZE_SOURCE_DIR) / "cuda/subject/styles";

// For each style, a part of the message that explains why it has no twin; empty for a style with a twin.
const std::map<std::string, std::string> kStyleTwins = {
    {"approximate", "cannot be replayed: rsqrt.approx.f32"},
    {"bit_tricks", ""},
    {"divisions", ""},
    {"early_returns", ""},
    {"edge_loops", ""},
    {"fma_by_hand", ""},
    {"in_double", ""},
    {"min_max", ""},
    {"noinline_helpers", ""},
    {"operators", ""},
    {"reciprocal", ""},
    {"recursion", ""},
    {"rolled_loops", ""},
    {"rounding", ""},
    {"square_root", ""},
    {"struct_return", ""},
    {"subnormals", ""},
    {"switch_case", ""},
    {"tables", ""},
    {"templates", ""},
};

// A cache for all tests of this process.
const fs::path& cache() {
  static const Scratch folder(fs::temp_directory_path());
  return folder.path();
}

const std::vector<CudaBuild>& builds_of(const std::string& style) {
  static std::map<std::string, std::vector<CudaBuild>> all;
  auto& builds = all[style];
  if (builds.empty()) builds = build_cuda_subject(kStyles / (style + ".cu"), "intersects", {}, cache());
  return builds;
}

bool no_nvrtc(std::string& why) {
  try {
    Nvrtc::get();
    return false;
  } catch (const std::runtime_error& error) {
    why = error.what();
    return true;
  }
}

std::vector<Pair> pairs_of_all_strata(std::uint64_t each) {
  std::vector<Pair> pairs;
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::uint64_t i = 0; i < each; ++i) pairs.push_back(strata::generate(7, row.stratum, i));
  }
  return pairs;
}

// The style's answers when compiled by the host's compiler, which rounds every operation. cuda/subject/styles/host.h
// replaces CUDA's functions.
std::vector<std::int8_t> on_host(const std::string& style, Scalar scalar, const std::vector<Pair>& pairs) {
  const Scratch scratch(cache());
  const fs::path in = scratch.path() / "host.cpp", out = scratch.path() / "host.so";
  const std::string real = scalar == Scalar::f32 ? "float" : "double";
  std::ofstream(in) << fmt::format(
      "#include \"{0}/host.h\"\n#include \"{0}/{1}.cu\"\nextern \"C\" void decide(const float* pairs, unsigned long "
      "count, signed char* answers) {{\n  for (unsigned long i = 0; i < count; ++i) {{\n    {2} p[18];\n    for (int k "
      "= 0; k < 18; ++k) p[k] = pairs[18 * i + k];\n    const int is = intersects(p, p + 9);\n    answers[i] = is < 0 "
      "? "
      "-1 : is != 0;\n  }}\n}}\n",
      kStyles.string(), style, real);
  std::string said;
  if (run_program({{"c++", "-std=c++20", "-O1", "-fPIC", "-shared", "-ffp-contract=off", "-frounding-math", "-w", "-o",
                    out.string(), in.string()}},
                  scratch.path(), said) != 0)
    throw std::runtime_error(said);
  void* library = dlopen(out.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw std::runtime_error(dlerror());
  std::vector<std::int8_t> answers(pairs.size());
  reinterpret_cast<void (*)(const float*, unsigned long, signed char*)>(dlsym(library, "decide"))(
      coordinates(pairs[0]), pairs.size(), answers.data());
  dlclose(library);
  return answers;
}

void expect_twin_or_refusal(const std::string& style, const std::string& refusal) {
  for (const CudaBuild& build : builds_of(style)) {
    if (build.variant == Variant::cuda_fast && build.twin.empty()) {
      EXPECT_NE(build.why_no_twin.find("cannot be replayed"), std::string::npos) << build.why_no_twin;
      continue;
    }
    if (!refusal.empty()) {
      EXPECT_TRUE(build.twin.empty());
      EXPECT_NE(build.why_no_twin.find(build.variant == Variant::cuda_nofma ? refusal : "cannot be replayed"),
                std::string::npos)
          << build.why_no_twin;
      continue;
    }
    EXPECT_EQ(build.why_no_twin, "") << name(build.variant);
    EXPECT_TRUE(fs::exists(build.twin));
    if (!find_ptxas(Nvrtc::get().library()).empty()) {
      EXPECT_TRUE(build.machine_code_identical) << name(build.variant);
      EXPECT_EQ(evidence(build), "twin, machine code identical");
    }
  }
}

void expect_twin_equals_host(const std::string& style) {
  const CudaBuild& build = builds_of(style).at(0);
  ASSERT_EQ(build.variant, Variant::cuda_nofma);
  ASSERT_EQ(build.why_no_twin, "");
  const std::vector<Pair> pairs = pairs_of_all_strata(6000);
  const std::vector<std::int8_t> expected = on_host(style, build.scalar, pairs);
  std::vector<std::int8_t> found(pairs.size());
  TwinLibrary(build.twin, build.scalar).decide(pairs, found.data());
  int wrong = 0;
  std::map<int, int> answers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ++answers[found[i]];
    // The min_max style copies a difference's sign. A NaN difference is negative on x86, but not on a GPU or in a twin.
    const Vec3<float>&p = pairs[i].a[0], &q = pairs[i].b[0];
    if (style == "min_max" && std::isnan(p.y * q.y - p.z * q.z)) continue;
    if (found[i] != expected[i] && wrong++ < 3)
      ADD_FAILURE() << strata::kStrata[i / 6000].id << " " << i % 6000 << ": twin " << int{found[i]} << ", host "
                    << int{expected[i]};
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(answers[0], 100);  // the predicate gives both answers
  EXPECT_GT(answers[1], 100);
}

void expect_unfused_is_without_contraction(const std::string& style) {
  const CudaBuild &rounded = builds_of(style).at(0), &contracted = builds_of(style).at(1);
  ASSERT_EQ(contracted.variant, Variant::cuda_fma);
  const TwinLibrary with(contracted.twin, contracted.scalar), without(rounded.twin, rounded.scalar);
  EXPECT_TRUE(without.sites().empty());
  const std::vector<std::uint64_t> none(with.sites().size() / 64 + 1), all(none.size(), ~std::uint64_t{0});
  const std::vector<Pair> pairs = pairs_of_all_strata(100);
  std::vector<std::int8_t> fused(pairs.size()), plain(pairs.size());
  with.decide(pairs, fused.data());
  without.decide(pairs, plain.data());
  int wrong = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    wrong += with.decide_fusing(pairs[i], all) != fused[i];
    wrong += with.decide_fusing(pairs[i], none) != plain[i];
  }
  EXPECT_EQ(wrong, 0);
  for (const ContractionSite& site : with.sites()) {
    EXPECT_EQ(fs::path(site.at.file).filename(), style + ".cu");
    EXPECT_GT(site.at.line, 1);
  }
}

class Style : public testing::TestWithParam<std::pair<const std::string, std::string>> {};

// One test checks all properties of a style, because the style's builds take most of the time.
TEST_P(Style, HasATwinThatEqualsTheHostCompilerOrIsRefusedByName) {
  if (std::string why; no_nvrtc(why)) GTEST_SKIP() << why;
  const auto& [style, refusal] = GetParam();
  expect_twin_or_refusal(style, refusal);
  if (!refusal.empty() || HasFailure()) return;
  expect_twin_equals_host(style);
  expect_unfused_is_without_contraction(style);
}

INSTANTIATE_TEST_SUITE_P(All, Style, testing::ValuesIn(kStyleTwins), [](const auto& row) { return row.param.first; });

TEST(Styles, AreAllTested) {
  std::set<std::string> files, tested;
  for (const auto& entry : fs::directory_iterator(kStyles)) {
    if (entry.path().extension() == ".cu") files.insert(entry.path().stem());
  }
  for (const auto& [style, refusal] : kStyleTwins) tested.insert(style);
  EXPECT_EQ(files, tested);
  EXPECT_EQ(files.size(), 20u);
}

}  // namespace
}  // namespace graze::cuda
