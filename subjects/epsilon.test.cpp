// SPDX-License-Identifier: Apache-2.0
#include "subjects/epsilon.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "core/message_testing.h"

namespace graze::subjects {
namespace {

Epsilon found(std::string_view text, const std::string& name = "") { return epsilon_of("/a/mine.cpp", text, name); }

std::string error_of(std::string_view text, const std::string& name = "") {
  return graze::error_of<UsageError>([&] { found(text, name); });
}

TEST(Epsilon, IsTheConstantThatSoundsLikeOne) {
  for (const char* text :
       {"const float kEps = 1e-6f;", "static constexpr float kEps{1e-6f};", "#define kEps 1e-6f\n",
        "#define kEps (1e-6f)", "bool f(const float* a, float kEps = 1e-6f);", "float a = 0.5f, kEps = 1e-6f;",
        "float a, kEps = 1e-6f;", "float a = f(1, 2), b, kEps = 1e-6f;",
        "// kEps = 3;\nconst char* s = \"eps = 4.0\"; /* double eps = 5.0; */ float kEps = 1e-6f;"}) {
    const Epsilon e = found(text);
    EXPECT_EQ(e.name, "kEps") << text;
    EXPECT_EQ(e.written, "1e-6f") << text;
    EXPECT_EQ(e.value, 1e-6) << text;
    ASSERT_EQ(e.places.size(), 1u) << text;
    EXPECT_EQ(std::string_view(text).substr(e.places[0].begin, 5), "1e-6f") << text;
  }
  EXPECT_EQ(found("const double tolerance = 0.5;").name, "tolerance");
  EXPECT_EQ(found("double my_eps = 0x1p-20;").value, 0x1p-20);
  EXPECT_EQ(found("double eps = 1'000.5e-9;").value, 1000.5e-9);
}

TEST(Epsilon, IsElseTheOnlySmallNumber) {
  const Epsilon e = found("bool f(float x) {\n  return x < 1e-6f ||\n -x < 1e-6f; }");
  EXPECT_EQ(e.name, "1e-6f");
  EXPECT_EQ(places_in_words("/a/mine.cpp", e), "mine.cpp:2 and 3");
  EXPECT_EQ(found("float half = 0.5f; float zero = 0.0f; float small = 1e-5f;").name, "small");
}

TEST(Epsilon, IsAnExpressionWhereItsNameSaysSo) {
  const Epsilon e = found("const float eps = 4 * FLT_EPSILON;");
  EXPECT_EQ(e.written, "4 * FLT_EPSILON");
  EXPECT_FALSE(e.value);
}

TEST(Epsilon, EveryDefinitionOfTheNameCounts) {
  const std::string text = "#ifdef F\n#define EPS 1e-6f\n#else\n#define EPS 1e-12\n#endif\n";
  const Epsilon e = found(text);
  EXPECT_EQ(places_in_words("mine.c", e), "mine.c:2 and 4");
  EXPECT_EQ(places_in_words("/a\n/mi\033[1mne.c", e), "mi\\x1b[1mne.c:2 and 4");
  EXPECT_EQ(with_value(text, {e}, 0.25, SourceLanguage::c),
            "#ifdef F\n#define EPS 0.25f\n#else\n#define EPS 0.25f\n#endif\n");
}

TEST(Epsilon, WhatIsNotObviousIsSaid) {
  EXPECT_TRUE(names(error_of("const float eps_a = 1e-6f, b = 0; const float eps_b = 1e-9f;"),
                    {"mine.cpp", "eps_a at mine.cpp:1", "eps_b", "--epsilon"}));
  EXPECT_TRUE(names(error_of("return x < 1e-6 && y < 1e-7;"), {"1e-6 at mine.cpp:1", "1e-7", "--epsilon"}));
  EXPECT_TRUE(names(error_of("int x = 4; x = 1e-3; y == 0.5;", "gap"), {"gap", "mine.cpp", "1e-3"}));
  EXPECT_TRUE(names(error_of("int main() { return 0; }"), {"no epsilon in mine.cpp", "--epsilon"}));
  EXPECT_TRUE(names(graze::error_of<UsageError>([] { epsilon_of("mi\033[1mne.cpp", "int main() { return 0; }", ""); }),
                    {"no epsilon in mi\\x1b[1mne.cpp"}));
  EXPECT_TRUE(names(error_of("f(a, gap = 1e-3); b, gap = 1e-3;", "gap"), {"gap", "no such constant", "1e-3"}));
  EXPECT_EQ(found("return x < 1e-6 && y < 1e-7;", "1e-7").value, 1e-7);
  EXPECT_EQ(found("float eps = 1e-6f; float gap = 0.5f;", "gap").value, 0.5);
}

TEST(Epsilon, ANewValueKeepsTheTypeAndTheRestOfTheText) {
  const auto changed = [](std::string_view text, double value, SourceLanguage language = SourceLanguage::cpp) {
    return with_value(text, {found(text)}, value, language);
  };
  EXPECT_EQ(changed("auto eps = 1e-6f; // eps = 1e-6f", 3.05e-5), "auto eps = 3.05e-05f; // eps = 1e-6f");
  EXPECT_EQ(changed("double eps{1e-6};", 0), "double eps{0.0};");
  EXPECT_EQ(changed("f(x < 1e-6f, y < 1e-6f)", 1), "f(x < 1.0f, y < 1.0f)");
  EXPECT_EQ(changed("auto eps = 4 * FLT_EPSILON;", 2e-6),
            "auto eps = (static_cast<decltype(4 * FLT_EPSILON)>(2e-06));");
  EXPECT_EQ(changed("#define EPS (4 * FLT_EPSILON)\n", 2e-6, SourceLanguage::c),
            "#define EPS ((__typeof__((4 * FLT_EPSILON)))(2e-06))\n");
}

TEST(SmallNumbers, AreWhatMayBeAnEpsilonAtAllTheirPlaces) {
  constexpr std::string_view kSource =
      "#include <x.h>\n"
      "const float kEps = 1e-6f; // not 1e-7\n"
      "/* 1e-8 */ const char* text = \"1e-9 \\\" 1e-9\"; char c = '\"';\n"
      "float a = x1e-5, b = 3, c2 = 0.5f, d = 2e5, e = .001, f = 0x1p-20, g = 1e-6f;\n"
      "bool h = x < FLT_EPSILON || y < std::numeric_limits<float>::epsilon() || MY_FLT_EPSILON;\n"
      "float i = 0.0f, j = 1e-3L, k = 1'000.5, l = 10, m = p->x1.e2, n = 1e-2f;\n";
  std::vector<std::string> all;
  for (const Epsilon& number : small_numbers_in(kSource)) {
    for (const SourcePlace& place : number.places)
      EXPECT_EQ(kSource.substr(place.begin, place.end - place.begin), number.name);
    all.push_back(places_in_words(number.name, number));
  }
  EXPECT_EQ(all, (std::vector<std::string>{"1e-6f:2 and 4", ".001:4", "0x1p-20:4", "FLT_EPSILON:5",
                                           "std::numeric_limits<float>::epsilon():5", "1e-3L:6"}));
  EXPECT_EQ(with_value("x < 1e-6f || y < 1e-6f || z < 1e-7;", small_numbers_in("x < 1e-6f || y < 1e-6f || z < 1e-7;"),
                       0.25, SourceLanguage::cpp),
            "x < 0.25f || y < 0.25f || z < 0.25;");
}

// For any text, places lie within the text and do not overlap. Reading takes time proportional to the length.
TEST(Epsilon, AnyTextIsReadOnce) {
  const auto expect_places = [](const std::string& text) {
    std::vector<Epsilon> all = epsilons_in(text);
    for (Epsilon& number : small_numbers_in(text)) all.push_back(std::move(number));
    for (const Epsilon& e : all) {
      std::size_t end = 0;
      for (const SourcePlace& place : e.places) {
        EXPECT_GE(place.begin, end);
        EXPECT_LT(place.begin, place.end);
        EXPECT_LE(place.end, text.size());
        end = place.end;
      }
      EXPECT_FALSE(with_value(text, {e}, 0.5, SourceLanguage::cpp).empty());
    }
  };
  std::mt19937_64 random(1);
  const std::string_view parts[] = {"float ", "eps", " = ",      "1e-6f", "(",  ")",  "{",    "}",
                                    ";",      ",",   "#define ", "\n",    "\"", "'",  "/*",   "*/",
                                    "//",     "\\",  "R\"x(",    "0x",    ".",  "1e", "\xff", " "};
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (int k = 0; k < 40; ++k) text += parts[random() % std::size(parts)];
    expect_places(text);
  }
  for (const std::string_view part : {"float eps = (", "float eps = ", "R\"(", "#define eps ", "/*", "x 1e-6"}) {
    std::string text;
    while (text.size() < 500'000) text += part;
    expect_places(text);
  }
  EXPECT_THROW(epsilons_in(std::string((1 << 20) + 1, ' ')), std::runtime_error);
}

}  // namespace
}  // namespace graze::subjects
