// SPDX-License-Identifier: Apache-2.0
// Tests causes that are found by changing and rebuilding a user's source.
#include "analysis/changed_source.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "analysis/experiments.h"
#include "analysis/scales.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"
#include "strata/strata.h"
#include "subjects/rebuilt.h"
#include "subjects/subjects.h"

namespace graze::analysis {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHead = "bool intersects(const float a[9], const float b[9]) {\n";

class ExperimentsOnSources : public testing::Test {
 protected:
  ExperimentsOnSources() {
    fs::create_directories(folder_);
    setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
  }
  ~ExperimentsOnSources() override { fs::remove_all(folder_); }

  const Lane& opened(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / (name + ".cpp")) << text;
    subjects::open({name, folder_ / (name + ".cpp"), {}});
    return *find_lane(name + "/f32/cpu");
  }

  // The experiment on a lane that is wrong on the pair.
  static Experiment found(const Lane& lane, const Pair& pair) {
    const Verdict truth = relation_of(pair).verdict, verdict = decide_lane(lane, pair);
    EXPECT_NE(verdict, truth);
    const Experiment result = experiment(lane, verdict, pair, truth);
    EXPECT_GT(result.asked, 0);
    EXPECT_LE(result.asked, kMostAsked);
    return result;
  }

  fs::path folder_ = fs::temp_directory_path() / ("graze-changed-" + std::to_string(getpid()));
};

bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

// These triangles intersect. Their coordinates are not small integers, so products round.
const Pair kFine{{{0.0117f, 0.0231f, 0.0119f}, {4.0177f, 0.0313f, 0.0171f}, {0.0239f, 4.0191f, 0.0113f}},
                 {{1.0133f, 1.0171f, -1.0193f}, {1.0271f, 1.0131f, 1.0119f}, {3.0117f, 3.0213f, 1.0157f}}};

// With a negligible unit, the products in the wrong comparison underflow, which makes the code right.
TEST_F(ExperimentsOnSources, AUnitIsNoEpsilon) {
  const Lane& lane = opened(
      "units", std::string(kHead) +
                   "  const float metres = 1e-3f;\n"
                   "  float p[9], q[9];\n"
                   "  for (int i = 0; i < 9; ++i) p[i] = a[i] * metres, q[i] = b[i] * metres;\n"
                   "  if ((p[3] - p[0]) * (p[7] - p[1]) - (p[4] - p[1]) * (p[6] - p[0]) < 0) return 0;  // the defect\n"
                   "  for (int k = 0; k < 3; ++k) {\n"
                   "    float pl = p[k], ph = p[k], ql = q[k], qh = q[k];\n"
                   "    for (int i = k; i < 9; i += 3) {\n"
                   "      if (p[i] < pl) pl = p[i];\n"
                   "      if (p[i] > ph) ph = p[i];\n"
                   "      if (q[i] < ql) ql = q[i];\n"
                   "      if (q[i] > qh) qh = q[i];\n"
                   "    }\n"
                   "    if (ph < ql || qh < pl) return 0;\n"
                   "  }\n"
                   "  return 1;\n"
                   "}\n");
  const Pair clockwise{{{0, 0, 0}, {0, 100, 0}, {100, 0, 0}}, {{25, 25, -100}, {25, 25, 100}, {300, 300, 300}}};
  const Experiment one = found(lane, clockwise);
  EXPECT_TRUE(one.line.empty()) << one.line;
  EXPECT_FALSE(has(one.evidence, "in place of 1e-3f")) << one.evidence;
  EXPECT_NE(one.cause, Cause::relative_epsilon);
  EXPECT_NE(one.cause, Cause::absolute_epsilon);
}

// On some pairs, another weight makes the code right by luck.
TEST_F(ExperimentsOnSources, AWeightIsNoEpsilon) {
  const Lane& lane =
      opened("weighs", std::string(kHead) + "  return a[0] + 0.05f * 20 * a[4] < b[0] + 0.05f * 20 * b[7];\n}\n");
  int by_luck = 0;
  for (const strata::Stratum stratum : {strata::Stratum::uniform, strata::Stratum::near_vertex_face}) {
    for (std::uint64_t i = 0; i < 80; ++i) {
      const Pair pair = strata::generate(7, stratum, i);
      if (decide_lane(lane, pair) == relation_of(pair).verdict) continue;
      const Experiment one = found(lane, pair);
      EXPECT_TRUE(one.line.empty()) << one.line;
      if (!has(one.evidence, "in place of 0.05f at weighs.cpp:2 it is right")) continue;
      ++by_luck;
      EXPECT_FALSE(one.settled) << name(one.cause) << ' ' << one.evidence;
      EXPECT_TRUE(has(one.evidence, "but not in every order and mirror image")) << one.evidence;
    }
  }
  fmt::print("right by luck: {}\n", by_luck);
  EXPECT_GT(by_luck, 5);
}

TEST_F(ExperimentsOnSources, ANumberThatDecidesAtEveryScaleIsARelativeEpsilon) {
  const Lane& lane =
      opened("relative", std::string(kHead) + "  volatile float eps = 1e-2f;\n  return eps < 1e-5f;\n}\n");
  const Experiment one = found(lane, kFine);
  EXPECT_EQ(one.cause, Cause::relative_epsilon) << one.evidence;
  EXPECT_TRUE(one.settled) << one.evidence;
  EXPECT_EQ(one.line, "relative.cpp:2");
  EXPECT_TRUE(
      has(one.evidence, "with 1e-36f in place of 1e-2f at relative.cpp:2 it is right; it is wrong at all larger"))
      << one.evidence;
  // At larger scales products overflow, because the first pair is too large and the second spans too many exponents.
  Pair wide = analysis::scaled(kFine, 18);
  wide.a[0].x = 0x1p-40f;
  for (const Pair& pair : {analysis::scaled(kFine, 30), wide}) {
    const Experiment open = found(lane, pair);
    EXPECT_EQ(open.cause, Cause::relative_epsilon) << open.evidence;
    EXPECT_FALSE(open.settled) << open.evidence;
    EXPECT_TRUE(has(open.evidence, "in place of 1e-2f")) << open.evidence;
    EXPECT_TRUE(has(open.evidence, "wrong at all larger scales that were tried, up to 2^")) << open.evidence;
  }
}

// An absolute epsilon may become negligible only at scales at which longer products than those of this code overflow.
// Built in doubles, this code has no epsilon, so that test does not tell rounding from the epsilon either.
TEST_F(ExperimentsOnSources, AnEpsilonThatVanishesOnlyAtHugeScalesIsNotSettled) {
  const Lane& lane = opened("gap", std::string(kHead) + R"(  volatile float whole = 16777216;
  whole = whole + 1;
  const float tolerance = whole == 16777216 ? 0.1f : 0.0f;
  for (int sign = -1; sign < 2; sign += 2) {
    float low[2], high[2];
    for (int t = 0; t < 2; ++t) {
      const float* v = t ? b : a;
      low[t] = high[t] = v[0] + sign * v[1];
      for (int i = 3; i < 9; i += 3) {
        const float x = v[i] + sign * v[i + 1];
        low[t] = x < low[t] ? x : low[t];
        high[t] = x > high[t] ? x : high[t];
      }
    }
    if (low[1] > high[0] + tolerance || low[0] > high[1] + tolerance) return false;
  }
  return true;
}
)");
  const Pair apart{{{0.7131f, -0.7131f, 0.31f}, {0.2133f, -0.8131f, 0.77f}, {-0.3177f, -0.513f, 1.13f}},
                   {{0.3217f, -0.32169997f, 0.21f}, {0.9131f, 0.7133f, 0.517f}, {0.6171f, 0.337f, -0.713f}}};
  const Experiment one = found(lane, apart);
  EXPECT_EQ(one.cause, Cause::absolute_epsilon) << one.evidence;
  EXPECT_FALSE(one.settled) << one.evidence;
  EXPECT_TRUE(has(one.evidence, "it is wrong at all larger scales that were tried, up to 2^") &&
              has(one.evidence, ", but right at 2^"))
      << one.evidence;
}

// This code is wrong in half of the orders and declines in the others.
TEST_F(ExperimentsOnSources, CodeThatDeclinesInSomeOrdersIsNotWrongInAll) {
  std::ofstream(folder_ / "declines.cpp") << "int intersects(const float a[9], const float b[9]) {\n"
                                             "  return a[0] == 0 || b[0] == 0 ? -1 : 0;\n}\n";
  subjects::open({"declines", folder_ / "declines.cpp", {}});
  const Pair meets{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {2, 1, 0}, {2, 0, 1}}};
  const Experiment one = found(*find_lane("declines/f32/cpu"), meets);
  EXPECT_FALSE(one.settled) << one.evidence;
  EXPECT_TRUE(has(one.evidence, "it declines some of the pairs that were tried")) << one.evidence;
}

// The epsilon has a length of its own: a fourth power of lengths is compared with a third power.
TEST_F(ExperimentsOnSources, AnEpsilonThatVanishesAtSmallScalesIsNotSettledAsRelative) {
  const Lane& lane = opened("powers", std::string(kHead) +
                                          "  float s = 0;\n  for (int i = 0; i < 9; ++i) s = a[i] > s ? a[i] : s;\n"
                                          "  return s * s * s >= 1e-3f * s * s * s * s;\n}\n");
  for (const int k : {14, 15}) {
    const Experiment one = found(lane, analysis::scaled(kFine, k));
    EXPECT_FALSE(one.settled) << k << ' ' << one.evidence;
    EXPECT_TRUE(has(one.evidence, "but right at 2^-")) << k << ' ' << one.evidence;
  }
}

// Another number makes the code right at small scales. So the number that decides here is not absolute.
TEST_F(ExperimentsOnSources, ANumberIsNotAbsoluteBecauseAnotherOneIs) {
  const Lane& lane =
      opened("guarded", std::string(kHead) +
                            "  float s = 0;\n  for (int i = 0; i < 9; ++i) s = a[i] > s ? a[i] : s;\n"
                            "  if (s < 0.002f) return true;\n  return s / (s + s) * 1e-4f >= 1e-3f;\n}\n");
  const Experiment one = found(lane, kFine);
  EXPECT_FALSE(one.settled) << name(one.cause) << ' ' << one.evidence;
}

// Large triangles are outside this code's world, and it is right about them by luck.
TEST_F(ExperimentsOnSources, ABoundOfTheWorldIsNoEpsilon) {
  const Lane& lane = opened("world", std::string(kHead) +
                                         "  for (int i = 0; i < 9; ++i) if (a[i] > 30 || b[i] > 30) return true;\n"
                                         "  return false;\n}\n");
  const Experiment one = found(lane, {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {2, 1, 1}}});
  EXPECT_FALSE(one.settled) << name(one.cause) << ' ' << one.evidence;
  EXPECT_TRUE(has(one.evidence, "but there it says the same of pairs with another truth")) << one.evidence;
}

TEST_F(ExperimentsOnSources, ALimitOfItsOwnIsNoOverflow) {
  const Lane& lane =
      opened("limit",
             std::string(kHead) + "  for (int i = 0; i < 9; ++i) if (a[i] > 1e15f) return false;\n  return true;\n}\n");
  const Experiment one = found(lane, analysis::scaled(kFine, 60));
  EXPECT_FALSE(one.settled) << name(one.cause) << ' ' << one.evidence;
}

// Contraction makes this code wrong here. With a negligible epsilon, the build without contraction is right, but the
// contracted build is not.
TEST_F(ExperimentsOnSources, AnEpsilonIsTriedInTheLanesOwnBuild) {
  opened("apart", R"(struct V { float x, y, z; };
static V of(const float* p, int i) { return {p[3 * i], p[3 * i + 1], p[3 * i + 2]}; }
static V operator-(V p, V q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
static float dot(V p, V q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
static V cross(V p, V q) { return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}; }
static bool separates(V n, const float* a, const float* b) {
  float al = dot(n, of(a, 0)), ah = al, bl = dot(n, of(b, 0)), bh = bl;
  for (int i = 1; i < 3; ++i) {
    const float x = dot(n, of(a, i)), y = dot(n, of(b, i));
    al = x < al ? x : al, ah = x > ah ? x : ah, bl = y < bl ? y : bl, bh = y > bh ? y : bh;
  }
  return bl > ah + 1e-6f || al > bh + 1e-6f;
}
bool intersects(const float a[9], const float b[9]) {
  V e[3], f[3];
  for (int i = 0; i < 3; ++i) e[i] = of(a, (i + 1) % 3) - of(a, i), f[i] = of(b, (i + 1) % 3) - of(b, i);
  if (separates(cross(e[0], e[1]), a, b) || separates(cross(f[0], f[1]), a, b)) return false;
  for (int i = 0; i < 9; ++i)
    if (separates(cross(e[i / 3], f[i % 3]), a, b)) return false;
  return true;
}
)");
  const Lane& fused = *find_lane("apart/f32/cpu-fma");
  if (!runs_on_this_cpu(fused)) GTEST_SKIP() << "this processor has no FMA instructions";
  int wrong = 0, named = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const Pair pair = strata::generate(5, strata::Stratum::near_edge_edge, i);
    const Verdict truth = relation_of(pair).verdict;
    if (decide_lane(fused, pair) == truth || decide_lane(*find_lane("apart/f32/cpu"), pair) == truth) continue;
    const Experiment one = found(fused, pair);
    ++wrong;
    if (!has(one.evidence, " in place of 1e-6f at apart.cpp:12 it is right")) continue;
    ++named;
    const subjects::ChangedCode exact = subjects::changed(fused, {.negligible = subjects::small_numbers(fused)});
    EXPECT_EQ(verdicts_of(*exact, std::span<const Pair>(&pair, 1))[0], truth) << one.evidence;
  }
  EXPECT_GT(named, 5);
  EXPECT_GT(wrong, named);
}

// If a source selects code by flags or types, a build with other flags or types shows nothing about this code.
TEST_F(ExperimentsOnSources, CodeSelectedByTheBuildIsNotSettledByOtherBuilds) {
  const std::string boxes =
      "  for (int c = 0; c < 3; ++c) {\n"
      "    float al = a[c], ah = al, bl = b[c], bh = bl;\n"
      "    for (int v = c + 3; v < 9; v += 3) {\n"
      "      al = a[v] < al ? a[v] : al, ah = a[v] > ah ? a[v] : ah;\n"
      "      bl = b[v] < bl ? b[v] : bl, bh = b[v] > bh ? b[v] : bh;\n"
      "    }\n";
  const std::string by_macro = "#ifdef __FMA__\n    if (ah <= bl || bh <= al) return false;\n#endif\n";
  const std::string by_size = "    if (sizeof al == 4 && (ah <= bl || bh <= al)) return false;\n";
  const std::string end = "    if (ah < bl || bh < al) return false;\n  }\n  return true;\n}\n";
  const Pair touching{{{0.1f, 0.2f, 0.3f}, {0.4f, 0.9f, 0.2f}, {0.7f, 0.1f, 0.6f}},
                      {{0.1f, 0.2f, 0.3f}, {0.05f, 0.5f, 0.9f}, {-0.3f, 0.8f, 0.4f}}};
  const Experiment size = found(opened("by_size", kHead + boxes + by_size + end), touching);
  EXPECT_FALSE(size.settled) << name(size.cause) << ' ' << size.evidence;
  std::ofstream(folder_ / "strict.h") << "#ifdef __FMA__\n#define STRICT\n#endif\n";
  const std::string by_header = "#ifdef STRICT\n    if (ah <= bl || bh <= al) return false;\n#endif\n";
  opened("by_header", std::string("#include \"strict.h\"\n") + kHead + boxes + by_header + end);
  opened("by_macro", kHead + boxes + by_macro + end);
  const Lane& fused = *find_lane("by_macro/f32/cpu-fma");
  if (!runs_on_this_cpu(fused)) GTEST_SKIP() << "this processor has no FMA instructions";
  const Experiment macro = found(fused, touching);
  EXPECT_FALSE(macro.settled) << name(macro.cause) << ' ' << macro.evidence;
  const Experiment header = found(*find_lane("by_header/f32/cpu-fma"), touching);
  EXPECT_FALSE(header.settled) << name(header.cause) << ' ' << header.evidence;
}

TEST_F(ExperimentsOnSources, ANumberBesideAnOpenUnderflowIsNotSettled) {
  const Lane& lane = opened(
      "small", std::string("bool intersects(const double*, const double*) { return true; }\n") + kHead +
                   "  float most = 0;\n  for (int i = 0; i < 9; ++i) most = a[i] > most ? a[i] : most;\n  for (int i = "
                   "0; i < 9; ++i) most = b[i] > most ? b[i] : most;\n  return !(most < 1e-4f);\n}\n");
  ASSERT_TRUE(find_lane("small/f64/cpu"));
  const Experiment one = found(lane, analysis::scaled(kFine, -18));
  EXPECT_FALSE(one.settled) << name(one.cause) << ' ' << one.evidence;
  EXPECT_TRUE(has(one.evidence, "in place of 1e-4f at small.cpp:6 it is right; scaled by 2^")) << one.evidence;
  EXPECT_FALSE(has(one.evidence, "larger scales")) << one.evidence;
}

// Initialising arrays changes the machine code, and on an x87 may change which values are spilled. This code reveals a
// change of its machine code, because its verdict depends on that machine code's size.
TEST_F(ExperimentsOnSources, OtherMachineCodeIsNoVariableWithoutAValue) {
  const Lane& lane = opened("measures", R"(
extern "C" __attribute__((visibility("hidden"))) const char begin_here[], end_here[];
static __attribute__((noipa)) float fifth(const float* from) {
  asm volatile("begin_here:" ::: "memory");
  float all[64];
  asm volatile("" ::"r"(all) : "memory");
  asm volatile("end_here:" ::: "memory");
  for (int i = 0; i < 64; ++i) all[i] = from[i % 9];
  asm volatile("" ::"r"(all) : "memory");
  return all[5];
}
bool intersects(const float a[9], const float*) { return fifth(a) == a[5] && end_here - begin_here >= 8; }
)");
  const auto verdict_on_fine = [](const DecideBlock& block) { return decide_one(block, kFine); };
  int right = 0;
  EXPECT_FALSE(by_initial_values(lane, Verdict::intersects, [&](const DecideBlock& block) {
    const Verdict verdict = verdict_on_fine(block);
    right += verdict == Verdict::intersects;
    return verdict;
  }));
  EXPECT_EQ(right, 2);
  const Pair small{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}};
  for (const Pair& pair : {kFine, small}) EXPECT_NE(found(lane, pair).cause, Cause::uninitialised);
}

// If any value makes the code right, only the compiler's warning points to the variable, and rounding must be ruled
// out.
TEST_F(ExperimentsOnSources, AVariableThatTheCompilerWarnsOfIsSettledOnSmallIntegers) {
  const Lane& lane = opened("unset", std::string(kHead) + R"(  int way;
  if (a[0] > 100) way = 1; else if (a[0] > 50) way = 2;
  float s = 0;
  for (int i = 0; i < 9; ++i) s += way == 2 ? a[i] + 1e3f : way == 1 ? b[i] + 1e3f : -1;
  return s < 0;
}
)");
  const Pair small{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}};
  for (const Pair* pair : {&small, &kFine}) {
    const Experiment one = found(lane, *pair);
    EXPECT_EQ(one.cause, Cause::uninitialised) << one.evidence;
    EXPECT_EQ(one.settled, pair == &small) << one.evidence;
    EXPECT_TRUE(has(one.evidence, "and the compiler warns of one")) << one.evidence;
  }
}

TEST_F(ExperimentsOnSources, AnEditedSourceIsNamedAsAnExperimentThatWasNotMade) {
  const std::string text =
      "bool intersects(const double*, const double*) { return false; }\n" + std::string(kHead) + "  return false;\n}\n";
  const Lane& lane = opened("edited", text);
  constexpr std::string_view kNotMade = "its C++ source, in which Graze changes numbers";
  const Experiment before = found(lane, kFine);
  EXPECT_FALSE(before.settled);
  EXPECT_TRUE(has(before.evidence, "to settle it, try")) << before.evidence;
  EXPECT_FALSE(has(before.evidence, kNotMade)) << before.evidence;
  std::ofstream(folder_ / "edited.cpp") << text << "// edited\n";
  EXPECT_TRUE(has(found(lane, kFine).evidence, kNotMade));
  fs::remove(folder_ / "edited.cpp");
  EXPECT_TRUE(has(found(lane, kFine).evidence, kNotMade));
}

// The source has six numbers. Changing any of them makes the code right on the pair, but not on all of its images.
TEST_F(ExperimentsOnSources, VerdictsOfChangedBuildsCountToo) {
  std::string text = std::string(kHead) + "  if (a[0] > 0 && a[2] < 0) return false;\n  float least = 1;\n";
  for (int i = 1; i <= 6; ++i)
    text += fmt::format("  {{ volatile float w = 0.0{}f; const float x = w; least = x < least ? x : least; }}\n", i);
  const Lane& lane = opened("numbers", text + "  return least < 0x1p-20;\n}\n");
  const Pair small{{{1, 1, 2}, {5, 1, 2}, {1, 5, 2}}, {{2, 2, 1}, {2, 2, 3}, {4, 4, 3}}};
  const Experiment one = found(lane, small);
  fmt::print("asked for {} verdicts: {}, {}\n", one.asked, name(one.cause), one.evidence);
  EXPECT_GT(one.asked, 78 + 7 * (1 + kMostImages) + 3 * 72);
}

}  // namespace
}  // namespace graze::analysis
