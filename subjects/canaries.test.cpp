// SPDX-License-Identifier: Apache-2.0
#include "subjects/toolchains/canaries.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "subjects/run_canaries.h"

namespace graze::subjects {
namespace {

CanaryResult result_in(const std::string& output, const std::string& name, const std::string& scalar) {
  const std::vector<CanaryResult> results = judge_canaries(output);
  return *std::find_if(results.begin(), results.end(),
                       [&](const CanaryResult& result) { return result.name == name && result.scalar == scalar; });
}

TEST(Canaries, AreJudgedByTheirBits) {
  const std::pair<const char*, const char*> kLines[] = {
      {"expression f32 0", "as written"},
      {"expression f32 b1800000", "fused"},          // -2^-28
      {"expression f64 bc50000000000000", "fused"},  // -2^-58
      {"expression f32 80000000", "other bits"},
      {"difference f32 b1800000", "left fused"},
      {"difference f32 32800000", "right fused"},    // 2^-26
      {"difference f32 32400000", "excess digits"},  // 3 * 2^-28
      {"dot f32 32800000 32800000", "2nd, 3rd fused"},
      {"order f32 3f800000 0 0", "as written"},
      {"order f32 0 0 3f800000", "regrouped"},
      {"order_in_loop f32 426c0000", "regrouped"},   // 59
      {"order_in_loop f32 427c0000", "other bits"},  // 63; no order gives this sum
      {"nearest f64 3ff0000000000000 3ff0000000000002 3ff0000000000000", "rounded twice"},
      {"reciprocal f32 3f800000 3f7fffff 3f800000 3f800000", "times 1/d"},
      {"division f64 0 4000", "as written"},
      {"division f64 7 4000", "7 of 16384 wrong"},
      {"division f64 0 3fff", "other bits"},                                 // too few divisions
      {"identities f32 7fc00000 ffc00000 7fc00001 ffffffff", "as written"},  // NaNs of any sign and payload
      {"identities f32 3f800000 ffc00000 0 7fc00000", "simplified"},
      {"identities f32 1007fc00000 7fc00000 7fc00000 7fc00000", "other bits"},  // too many bits for a float
      {"subnormal_result f32 400000 0", "flushed to 0"},
      {"zeros f32 80000000 0 0 0", "signs ignored"},
      {"nan f32 1 0 0 0", "NaN ignored"},
      {"sum f32 30800000", "regrouped"},          // 2^-30
      {"subnormal_nearest f64 2", "other bits"},  // looks like double rounding, but no other canary shows excess digits
      {"infinity f32 7f7fffff ff800000 1 1", "other bits"},
  };
  for (const auto& [line, found] : kLines) {
    std::istringstream words(line);
    std::string name, scalar;
    words >> name >> scalar;
    EXPECT_EQ(result_in(line, name, scalar).found, found) << line;
  }
}

// Fused operations and wide registers both leave a product unrounded, but only wide registers have a wider range.
TEST(Canaries, TellAFusedProductFromExcessPrecision) {
  EXPECT_EQ(result_in("range f32 7f800000\nstatements f32 b1800000", "statements", "f32").found, "fused");
  const CanaryResult wide = result_in("range f32 71800000\nstatements f32 b1800000", "statements", "f32");
  EXPECT_EQ(wide.found, "excess digits");
  EXPECT_EQ(wide.rounding, Rounding::excess);
  EXPECT_EQ(result_in("range f32 71800000\nsum f32 30800000", "sum", "f32").found, "excess digits");
}

TEST(Canaries, ACutOrForgedLineIsNoAnswer) {
  for (const std::string output :
       {"", "expression", "expression f32", "expression f32 ", "expression f32 0 0", "expression f32 0x0",
        "expression f32 -0", "expression f32 g", "expression f32 11111111111111111", "expression f16 0",
        "Expression f32 0", "expression f32 0\nexpression f32 0", "expression f32 0\nexpression f32",
        "expression f32 0\nexpression f32 b1800000", "expression  f32\t0 1 2 3 4 5 6 7 8 9 a b c d e f"}) {
    EXPECT_EQ(result_in(output, "expression", "f32").found, "no answer") << output;
    EXPECT_EQ(measured_rounding(judge_canaries(output)), std::nullopt);
  }
  EXPECT_EQ(result_in(std::string(1'000'000, '\xff'), "expression", "f32").found, "no answer");
  EXPECT_EQ(result_in(std::string(1'000'000, '\n') + std::string(100, '\0'), "expression", "f32").found, "no answer");
  EXPECT_EQ(compared(result_in("", "expression", "f32"), {}), Documented::no_claim);
}

TEST(Canaries, OfThisCompilerRoundAsWrittenWithoutContraction) {
#if !defined(__x86_64__) && !defined(__aarch64__)
  GTEST_SKIP() << "known for x86-64 and ARM64 only";
#endif
  const std::string output = run_canaries("c++ -O2 -ffp-contract=off", "");
  for (const CanaryResult& result : judge_canaries(output)) EXPECT_EQ(result.found, "as written") << result.name;
  EXPECT_EQ(measured_rounding(judge_canaries(output)), Rounding::rounded);
  // If a program is stopped early, its output gives no wrong answer, unless the output ends within a number.
  for (std::size_t length = 0; length + 2 < output.size(); length += 7)
    EXPECT_EQ(measured_rounding(judge_canaries(output.substr(0, output.rfind('\n', length) + 1))), std::nullopt);
}

// The canary of reciprocals computes x (1 / x). If 1 / x is rounded to m / 2^k, the canary computes x m / 2^k. Just
// below 1, neighbouring numbers are 32 / 2^k apart.
TEST(Canaries, ReciprocalsOf41And49RoundSoThatTheirProductIsNot1) {
  for (const auto& [x, k] : {std::pair<std::uint64_t, int>{41, 29}, {49, 58}}) {
    const std::uint64_t one = std::uint64_t{1} << k, m = (one + x / 2) / x;
    EXPECT_EQ(m >> (k - 6), 1u) << "24 or 53 digits";
    EXPECT_GT(one - x * m, 16u);
    EXPECT_LT(one - x * m, 48u);
  }
}

TEST(Canaries, AreComparedWithWhatIsDocumented) {
  const CanaryResult fused = result_in("statements f32 b1800000", "statements", "f32"),
                     rounds = result_in("statements f32 0", "statements", "f32"),
                     flushed = result_in("subnormal_input f32 0", "subnormal_input", "f32");
  EXPECT_EQ(compared(rounds, {Rounding::rounded, true}), Documented::holds);
  EXPECT_EQ(compared(fused, {Rounding::fast, true}), Documented::no_claim);
  EXPECT_EQ(compared(fused, {Rounding::fast, true, "", false}), Documented::does_not_hold);
  EXPECT_EQ(compared(flushed, {Rounding::fast, true, "", false}), Documented::no_claim);
  EXPECT_EQ(compared(fused, {Rounding::rounded, true}), Documented::does_not_hold);
  EXPECT_EQ(compared(rounds, {Rounding::contracted, true}), Documented::no_claim);
  EXPECT_EQ(compared(fused, {Rounding::contracted, true}), Documented::no_claim);
  EXPECT_EQ(compared(fused, {Rounding::contracted, false}), Documented::does_not_hold);
  EXPECT_EQ(compared(rounds, {Rounding::contracted, false}), Documented::holds);
  EXPECT_EQ(compared(flushed, {Rounding::excess, true}), Documented::does_not_hold);
  EXPECT_EQ(compared(flushed, {Rounding::fast, true}), Documented::no_claim);
}

TEST(Claim, FollowsTheFlagsOfGccAndClang) {
  const std::string gcc = "#define __GNUC__ 12\n#define __x86_64__ 1\n#define __FLT_EVAL_METHOD__ 0\n",
                    v3 = gcc + "#define __FMA__ 1\n", clang = v3 + "#define __clang__ 1\n",
                    arm64 = "#define __GNUC__ 12\n#define __aarch64__ 1\n",
                    x87 = "#define __GNUC__ 12\n#define __x86_64__ 1\n#define __FLT_EVAL_METHOD__ 2\n";
  const auto expect = [](const std::string& command, const std::string& macros, Rounding rounding, bool across = true) {
    const std::optional<Claim> claim = documented_claim(command, macros);
    ASSERT_TRUE(claim) << command;
    EXPECT_EQ(name(claim->rounding), name(rounding)) << command;
    EXPECT_EQ(claim->across_statements, across) << command;
  };
  expect("g++ -O2", gcc, Rounding::rounded);
  expect("g++ -O2", v3, Rounding::contracted);
  expect("g++ -O2 -std=c++20", v3, Rounding::contracted);
  expect("gcc -O2 -std=c11", v3, Rounding::rounded);
  expect("gcc -O2 -std=gnu11", v3, Rounding::contracted);
  expect("gcc -ffp-contract=on", v3, Rounding::rounded);
  expect("gcc -ffp-contract=on", "#define __GNUC__ 14\n#define __x86_64__ 1\n#define __FMA__ 1\n", Rounding::contracted,
         false);
  expect("gcc -ffp-contract=fast -ffp-contract=off", v3, Rounding::rounded);
  expect("gcc -ffp-contract=off -ffp-contract=fast", v3, Rounding::contracted);
  expect("aarch64-linux-gnu-g++", arm64, Rounding::contracted);
  expect("aarch64-linux-gnu-g++ -ffp-contract=off", arm64, Rounding::rounded);
  expect("clang", clang, Rounding::contracted, false);
  expect("clang -std=c11", clang, Rounding::contracted, false);
  expect("clang -ffp-contract=fast", clang, Rounding::contracted);
  expect("clang -ffp-model=strict", clang, Rounding::rounded);
  expect("clang -ffp-model=fast", clang, Rounding::fast);
  expect("gcc -mfpmath=387", x87, Rounding::excess);
  expect("gcc -mfpmath=387 -fexcess-precision=standard", x87, Rounding::excess, false);
  expect("gcc -mfpmath=387 -std=c11", x87, Rounding::excess, false);
  expect("gcc -ffast-math", gcc, Rounding::fast);
  EXPECT_TRUE(documented_claim("clang -ffp-contract=off -ffast-math", clang)->contraction);
  EXPECT_FALSE(documented_claim("clang -ffast-math -ffp-contract=off", clang)->contraction);
  expect("gcc -ffast-math -fno-fast-math", gcc, Rounding::rounded);
  expect("gcc -Ofast -fno-fast-math", gcc, Rounding::rounded);
  expect("gcc -Ofast -O2", gcc, Rounding::rounded);
  expect("gcc -O2 -Ofast", gcc, Rounding::fast);
  expect("gcc -ffast-math -fno-associative-math", gcc, Rounding::fast);
  EXPECT_EQ(documented_claim("icx", clang + "#define __INTEL_LLVM_COMPILER 20240000\n"), std::nullopt);
  EXPECT_EQ(documented_claim("tcc", "#define __TINYC__ 928\n"), std::nullopt);
}

}  // namespace
}  // namespace graze::subjects
