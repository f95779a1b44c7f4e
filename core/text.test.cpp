// SPDX-License-Identifier: Apache-2.0
// Tests that decimals are rounded once, ties to even, and that text that is not entirely a number is rejected.
#include "core/text.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <string>

#include <bit>
#include <cmath>
#include <limits>

namespace graze {
namespace {

constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

TEST(ParseFloat32, RoundsDecimalsOnce) {
  EXPECT_EQ(parse_float32("0.1"), 0x1.99999ap-4f);
  EXPECT_EQ(parse_float32("+1"), 1.0f);
  EXPECT_EQ(parse_float32(".5e1"), 5.0f);
  // Ties: 2^24 + 1 and 2^24 + 3 are halfway between floats, and are rounded to the even one.
  EXPECT_EQ(parse_float32("16777217"), 16777216.0f);
  EXPECT_EQ(parse_float32("16777219"), 16777220.0f);
  // Just beyond a tie, by less than a double can represent: two roundings would give 2^24.
  EXPECT_EQ(parse_float32("16777217.0000000001"), 16777218.0f);
  EXPECT_EQ(parse_float32("0x1000001.00000000001p0"), 16777218.0f);
  EXPECT_EQ(parse_float32("0x1000001p0"), 16777216.0f);
}

TEST(ParseFloat32, RoundsUnderflow) {
  EXPECT_EQ(parse_float32("1e-46"), 0.0f);
  EXPECT_EQ(bits(*parse_float32("-1e-46")), bits(-0.0f));
  EXPECT_EQ(parse_float32("1e-999"), 0.0f);
  EXPECT_EQ(parse_float32("7.1e-46"), kSmallest);
  EXPECT_EQ(parse_float32("1.4e-45"), kSmallest);
  EXPECT_EQ(parse_float32("0x1p-150"), 0.0f);  // a tie, to even
  EXPECT_EQ(parse_float32("0x1.8p-150"), kSmallest);
  EXPECT_EQ(parse_float32("0x1p-99999"), 0.0f);
}

TEST(ParseFloat32, RefusesOverflow) {
  EXPECT_EQ(parse_float32("3.4028235e38"), kMax);
  EXPECT_EQ(parse_float32("3.4028235677973366e38"), kMax);  // just short of halfway to 2^128
  EXPECT_EQ(parse_float32("3.4028236e38"), std::nullopt);   // beyond halfway
  EXPECT_EQ(parse_float32("-1e39"), std::nullopt);
  EXPECT_EQ(parse_float32("1e999"), std::nullopt);
  EXPECT_EQ(parse_float32("0x1.fffffefp127"), kMax);
  EXPECT_EQ(parse_float32("0x1.ffffffp127"), std::nullopt);
  EXPECT_EQ(parse_float32("0x1p128"), std::nullopt);
}

TEST(ParseFloat32, TakesInfAndNan) {
  EXPECT_EQ(parse_float32("inf"), kInfinity);
  EXPECT_EQ(parse_float32("-inf"), -kInfinity);
  EXPECT_TRUE(std::isnan(parse_float32("nan").value()));
}

TEST(ParseFloat32, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "-", "--1", "+-1", "1e", "1x", "0x", "0xinf", "0x-1", "1,5", ".", "one", "1 "}) {
    EXPECT_EQ(parse_float32(text), std::nullopt) << '"' << text << '"';
  }
}

TEST(ParseWhole, TakesDigitsThatFitAndNothingElse) {
  EXPECT_EQ(parse_whole("18446744073709551615"), ~std::uint64_t{0});
  for (const char* text : {"", "-1", "+1", " 1", "1 ", "0x1", "1.0", "18446744073709551616"})
    EXPECT_EQ(parse_whole(text), std::nullopt) << text;
}

TEST(Rounded, OutwardAndNoFartherThanTheNextDecimal) {
  EXPECT_EQ(rounded_up(0.02032, 2), "0.021");
  EXPECT_EQ(rounded_down(0.02032, 2), "0.02");
  EXPECT_EQ(rounded_up(0.02, 2), "0.02");
  EXPECT_EQ(rounded_down(0.02, 2), "0.02");
  EXPECT_EQ(rounded_up(0.0996, 2), "0.1");
  EXPECT_EQ(rounded_up(9.99e-6, 2), "1e-05");
  EXPECT_EQ(rounded_up(123456, 2), "1.3e+05");
  EXPECT_EQ(rounded_up(0, 3), "0");
  EXPECT_EQ(rounded_down(0, 3), "0");
  EXPECT_EQ(rounded_up(-0.02032, 2), "-0.02");
  EXPECT_EQ(rounded_down(-0.02032, 2), "-0.021");
  EXPECT_EQ(rounded_up(1, 1), "1");
  std::mt19937_64 bits(2012);
  int inexact = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double mantissa = 1 + static_cast<double>(bits() >> 12) * 0x1p-52;
    const double value = std::ldexp(mantissa, static_cast<int>(bits() % 120) - 60);
    const int digits = 1 + static_cast<int>(bits() % 6);
    const double up = std::stod(rounded_up(value, digits)), down = std::stod(rounded_down(value, digits));
    ASSERT_GE(up, value) << digits;
    ASSERT_LE(down, value) << digits;
    // The two are neighbours, and the nearest decimal is one of them.
    ASSERT_LE(up - down, 1.000001 * std::pow(10, 1 - digits) * up) << value << ' ' << digits;
    char nearest[32];
    std::snprintf(nearest, sizeof nearest, "%.*g", digits, value);
    ASSERT_TRUE(std::stod(nearest) == up || std::stod(nearest) == down) << value << ' ' << digits;
    inexact += up != down;
  }
  EXPECT_GT(inexact, 190'000);
}

TEST(Printable, ShowsControlCharactersAndForeignBytes) {
  EXPECT_EQ(printable("a \x1b[31mred\n\x7f\xc3\xbc\"\\"), "a \\x1b[31mred\\x0a\\x7f\\xc3\\xbc\"\\");
  EXPECT_EQ(in_quotes("\"\\\r"), "\"\\\"\\\\\\x0d\"");
  EXPECT_EQ(shown(std::string(41, 'x')), '"' + std::string(40, 'x') + "\"...");
}

TEST(ShellWord, QuotesWhereAShellWouldSplit) {
  EXPECT_EQ(shell_word("a/b-1.pairs"), "a/b-1.pairs");
  EXPECT_EQ(shell_word("my case's"), "'my case'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("-O3"), "-O3");
  EXPECT_EQ(path_word("a/-b"), "a/-b");
  EXPECT_EQ(path_word("--x"), "./--x");
  EXPECT_EQ(path_word("-my case"), "'./-my case'");
  EXPECT_EQ(shell_word("$(x)"), "'$(x)'");
  EXPECT_EQ(shell_word("a\x1b[1m'\\"), "$'a\\x1b[1m\\'\\\\'");
}

TEST(DidYouMean, NamesTheNearestOrNothing) {
  const std::vector<std::string> words{"minimize", "explain", "moller_1997/f32/cpu", "map"};
  EXPECT_EQ(did_you_mean("minimise", words), "; did you mean 'minimize'?");
  EXPECT_EQ(did_you_mean("explian", words), "; did you mean 'explain'?");
  EXPECT_EQ(did_you_mean("moler_*", words), "; did you mean 'moller_1997/f32/cpu'?");
  EXPECT_EQ(did_you_mean("moller_1977/*/cpu", words), "; did you mean 'moller_1997/f32/cpu'?");
  EXPECT_EQ(did_you_mean("nothing", words), "");
  EXPECT_EQ(did_you_mean("", words), "");
}

}  // namespace
}  // namespace graze
