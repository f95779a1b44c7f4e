// SPDX-License-Identifier: Apache-2.0
#include "reports/screen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "reports/text_table.h"

namespace graze::reports {
namespace {

int widest(const std::string& text) {
  std::istringstream lines(text);
  int most = 0;
  for (std::string line; std::getline(lines, line);) most = std::max(most, width_of(line));
  return most;
}

TEST(Screen, PlainByDefault) {
  EXPECT_EQ(Screen{}.columns, 80);
  EXPECT_EQ(red({}, "wrong"), "wrong");
  EXPECT_EQ(bold({}, "title"), "title");
  EXPECT_EQ(red({80, true}, "wrong"), "\033[1m\033[31mwrong\033[0m");
}

TEST(Screen, TextBreaksAtSpaces) {
  EXPECT_EQ(wrapped("one two three", 80, 2, 4), "  one two three\n");
  EXPECT_EQ(wrapped("one two three", 9, 2, 4), "  one two\n    three\n");
  EXPECT_EQ(wrapped("a/very/long/name b", 6, 0, 1), "a/very/long/name\n b\n");
  EXPECT_EQ(wrapped("2^-64…2^64 and more", 14), "2^-64…2^64 and\nmore\n");  // code points, not bytes
  EXPECT_EQ(wrapped("name      what it is", 15, 0, 10), "name      what\n          it is\n");
}

TextTable example() {
  TextTable table({{"lane", Align::left}, {"false positive"}, {"guigue_devillers_2003", Align::point}, {"exact"}});
  table.add({{"moller_1997"}, {"12", true}, {"47.8"}, {"0"}});
  table.add({{"sat"}, {"1,234"}, {"0.156"}, {"0"}});
  return table;
}

TEST(TextTable, PutsPointsBelowEachOther) {
  EXPECT_EQ(example().text({80, false}),
            "lane         false positive  guigue_devillers_2003  exact\n"
            "moller_1997              12                 47.8        0\n"
            "sat                   1,234                  0.156      0\n");
}

TEST(TextTable, BreaksItsHeadersOnANarrowScreen) {
  EXPECT_EQ(example().text({44, false}, 2),
            "                            guigue\n"
            "                  false  devillers\n"
            "  lane         positive       2003  exact\n"
            "  moller_1997        12     47.8        0\n"
            "  sat             1,234      0.156      0\n");
}

TEST(TextTable, PutsHeadersAboveInStepsOnANarrowerOne) {
  EXPECT_EQ(example().text({32, false}),
            "                        exact\n"
            "     guigue_devillers_2003  |\n"
            "    false positive       |  |\n"
            "lane             |       |  |\n"
            "moller_1997     12  47.8    0\n"
            "sat          1,234   0.156  0\n");
}

TEST(TextTable, ComesInBlocksOnTheNarrowest) {
  EXPECT_EQ(example().text({22, false}),
            "                false\n"
            "lane         positive\n"
            "moller_1997        12\n"
            "sat             1,234\n"
            "\n"
            "                guigue\n"
            "             devillers\n"
            "lane              2003\n"
            "moller_1997     47.8\n"
            "sat              0.156\n"
            "\n"
            "lane         exact\n"
            "moller_1997      0\n"
            "sat              0\n");
}

TEST(TextTable, SharesItsColumnsEvenlyByTheBlocks) {
  TextTable table({{"", Align::left}, {"one"}, {"two"}, {"six"}, {"ten"}});
  table.add({{"lane"}, {"12345678"}, {"12345678"}, {"12345678"}, {"1"}});
  EXPECT_EQ(table.text({34, false}),  // three columns would fit
            "           one       two\n"
            "lane  12345678  12345678\n"
            "\n"
            "           six  ten\n"
            "lane  12345678    1\n");
}

TEST(TextTable, FitsEveryScreenThatHoldsTheNamesAndAColumn) {
  for (int columns = 22; columns <= 100; ++columns) EXPECT_LE(widest(example().text({columns, false})), columns);
}

TEST(TextTable, ColourTakesNoRoom) {
  std::string coloured = example().text({80, true});
  EXPECT_NE(coloured.find("  \033[1m\033[31m12\033[0m  "), std::string::npos) << coloured;
  for (const std::string code : {"\033[0m", "\033[1m", "\033[31m"}) {
    for (std::size_t at; (at = coloured.find(code)) != coloured.npos;) coloured.erase(at, code.size());
  }
  EXPECT_EQ(coloured, example().text({80, false}));
}

}  // namespace
}  // namespace graze::reports
