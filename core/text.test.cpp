// SPDX-License-Identifier: Apache-2.0
// Numbers from text: decimals round once, ties to even, and what is no number in full is none.
#include "core/text.h"

#include <gtest/gtest.h>

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
  // Ties: 2^24 + 1 and 2^24 + 3 lie halfway, and go to the even neighbour.
  EXPECT_EQ(parse_float32("16777217"), 16777216.0f);
  EXPECT_EQ(parse_float32("16777219"), 16777220.0f);
  // Just beyond a tie, by less than a double can tell: two roundings would end at 2^24.
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
  EXPECT_EQ(parse_float32("3.4028236e38"), std::nullopt);   // beyond it
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

TEST(Printable, ShowsControlCharactersAndForeignBytes) {
  EXPECT_EQ(printable("a \x1b[31mred\n\x7f\xc3\xbc\"\\"), "a \\x1b[31mred\\x0a\\x7f\\xc3\\xbc\"\\");
  EXPECT_EQ(in_quotes("\"\\\r"), "\"\\\"\\\\\\x0d\"");
  EXPECT_EQ(shown(std::string(41, 'x')), '"' + std::string(40, 'x') + "\"...");
}

TEST(ShellWord, QuotesWhereAShellWouldSplit) {
  EXPECT_EQ(shell_word("a/b-1.pairs"), "a/b-1.pairs");
  EXPECT_EQ(shell_word("my case's"), "'my case'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
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
