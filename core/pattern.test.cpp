// SPDX-License-Identifier: Apache-2.0
#include "core/pattern.h"

#include <gtest/gtest.h>

namespace graze {
namespace {

// A million characters would overflow the stack of a matcher that recurses for each of them.
TEST(Pattern, LongTextsAreSearchedWithoutRecursion) {
  const std::string blanks(1'000'000, ' '), letters(1'000'000, 'a');
  const std::regex include("#[ \t]*include[ \t]*\""), word("\\bsizeof\\b");
  EXPECT_TRUE(contains("#" + blanks + "include" + blanks + "\"x.h\"", include));
  EXPECT_FALSE(contains("#" + blanks + "include" + blanks + "<x.h>", include));
  for (std::size_t at = 0; at < 3 * kMostMatched; at += 13) {
    const std::string before(at, '+');
    ASSERT_TRUE(contains(before + "sizeof+", word)) << at;
    ASSERT_FALSE(contains(before + "asizeof+", word)) << at;
  }
  EXPECT_FALSE(contains(letters, word));
  EXPECT_TRUE(contains(letters + " sizeof", word));
  EXPECT_FALSE(contains("", word));
}

TEST(Pattern, ATextThatIsTooLongDoesNotMatch) {
  const std::regex letters("(a*)");
  std::smatch match;
  const std::string most(kMostMatched, 'a');
  ASSERT_TRUE(matches(most, match, letters));
  EXPECT_EQ(match[1], most);
  EXPECT_FALSE(matches(most + 'a', letters));
  EXPECT_FALSE(matches("b", letters));
}

}  // namespace
}  // namespace graze
