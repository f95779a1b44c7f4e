// SPDX-License-Identifier: Apache-2.0
// Tests sources that are rebuilt with a change.
#include "subjects/rebuilt.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <thread>

#include "subjects/subjects.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

TEST(InDoubles, StandBehindTheLastInclude) {
  const auto without_functions = [](const std::string& text) {
    EXPECT_NE(text.find("#define fminf fmin\n"), text.npos);
    return std::regex_replace(text, std::regex("#define \\w+f \\w+\n"), "");
  };
  EXPECT_EQ(without_functions(in_doubles("#include <a>\n# include \"b\"\nfloat f;")),
            "#include <a>\n# include \"b\"\n\n#define float double\nfloat f;\n#undef float\n");
  EXPECT_EQ(without_functions(in_doubles("float f;\n")), "\n#define float double\nfloat f;\n\n#undef float\n");
}

class Rebuilt : public testing::Test {
 protected:
  Rebuilt() {
    fs::create_directories(folder_ / "src");
    setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
  }
  ~Rebuilt() override { fs::remove_all(folder_); }

  const Lane& opened_lane(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / "src" / (name + ".cpp")) << text;
    open(parse_subject(name + "=" + (folder_ / "src" / (name + ".cpp")).string()));
    return *find_lane(name + "/f32/cpu");
  }

  fs::path folder_ = fs::temp_directory_path() / ("graze-rebuilt-" + std::to_string(getpid()));
};

Verdict said(const ChangedCode& code, const Pair& pair) { return decide_one(*code, pair); }

long count_in(const char* folder) { return std::distance(fs::directory_iterator(folder), fs::directory_iterator()); }

// The processes whose parent is this one.
int children() {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream in(entry.path() / "status");
    for (std::string word; in >> word;) {
      if (word != "PPid:") continue;
      in >> word;
      count += word == std::to_string(getpid());
      break;
    }
  }
  return count;
}

// The source includes a file from its own folder. Verdicts depend on a small number, doubles and initial values.
TEST_F(Rebuilt, ChangesAreSeenInVerdicts) {
  std::ofstream(folder_ / "src/own.h") << "#define THERE 1\n";
  const Lane& lane = opened_lane("changes",
                                 "#include \"own.h\"\n"
                                 "bool intersects(const float a[9], const float b[9]) {\n"
                                 "  if (a[1] == 1) { volatile float x = a[0], y = x + 1; return y - 1 == x; }\n"
                                 "  if (a[1] == 2) { int unset[4]; int* volatile p = unset; return p[2] == 0; }\n"
                                 "  return THERE && a[0] - b[0] < 1e-3f;\n"
                                 "}\n");
  Pair pair{};
  pair.a[0] = {0x1p-11f, 0, 0};
  const std::vector<Epsilon> numbers = small_numbers(lane);
  ASSERT_EQ(numbers.size(), 1u);
  const auto smaller = changed(lane, {.negligible = numbers});
  ASSERT_TRUE(smaller);
  EXPECT_EQ(decide_one(lane.decide, pair), Verdict::intersects);
  EXPECT_EQ(said(smaller, pair), Verdict::disjoint);
  fs::remove_all(folder_ / "cache");
  EXPECT_EQ(said(changed(lane, {.negligible = numbers}), pair), Verdict::disjoint);
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache"))
    EXPECT_EQ(entry.path().filename().string().find("changed-"), std::string::npos) << "the source was built once more";
  pair.a[0] = {0x1p-30f, 1, 0};
  EXPECT_EQ(decide_one(lane.decide, pair), Verdict::disjoint);
  EXPECT_EQ(said(changed(lane, {.doubles = true}), pair), Verdict::intersects);
  pair.a[0] = {0, 2, 0};
  EXPECT_EQ(said(changed(lane, {.flags = {"-ftrivial-auto-var-init=zero"}}), pair), Verdict::intersects);
  EXPECT_EQ(said(changed(lane, {.flags = {"-ftrivial-auto-var-init=pattern"}}), pair), Verdict::disjoint);
}

// No matter how many threads ask, only the builds and a few processes remain. A build has one descriptor; a process has
// two.
TEST_F(Rebuilt, FewProcessesStay) {
  const Lane& lane = opened_lane(
      "many", "#ifndef N\n#define N 0\n#endif\nbool intersects(const float* a, const float*) { return *a < N; }\n");
  constexpr int kChanges = 4;
  const auto ask = [&] {
    for (int i = 0; i < kChanges; ++i) {
      Pair pair{};
      pair.a[0].x = static_cast<float>(i);
      const auto code = changed(lane, {.flags = {"-UN", "-DN=" + std::to_string(i)}});
      EXPECT_EQ(said(code, pair), Verdict::disjoint);
      pair.a[0].x -= 1;
      EXPECT_EQ(said(code, pair), Verdict::intersects);
    }
  };
  const long files = count_in("/proc/self/fd");
  const int before = children();
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 6; ++t) threads.emplace_back(ask);
  }
  EXPECT_LE(count_in("/proc/self/fd"), files + kChanges + 2 * kMostIdle);
  EXPECT_LE(children(), before + kMostIdle);
  EXPECT_LT(kMostIdle, 6 * kChanges);
}

TEST_F(Rebuilt, NothingIsBuiltWithoutTheSourceAsItWas) {
  const Lane& lane = opened_lane("edited", "bool intersects(const float* a, const float*) { return *a < 1e-3f; }\n");
  EXPECT_FALSE(changed(lane, {.flags = {"-no-such-flag"}}));
  EXPECT_TRUE(has_source_as_built(lane));
  EXPECT_EQ(small_numbers(lane).size(), 1u);
  std::ofstream(folder_ / "src/edited.cpp") << "bool intersects(const float* a, const float*) { return *a < 1e-4f; }\n";
  EXPECT_TRUE(small_numbers(lane).empty());
  EXPECT_FALSE(changed(lane, {.flags = {"-DX"}}));
  EXPECT_FALSE(has_source_as_built(lane));
  fs::remove(folder_ / "src/edited.cpp");
  EXPECT_FALSE(has_source_as_built(lane));
  EXPECT_FALSE(changed(lane, {.flags = {"-DX"}}));
  const Lane& published = lanes().front();
  EXPECT_FALSE(has_source_as_built(published));
  EXPECT_TRUE(small_numbers(published).empty());
  EXPECT_FALSE(changed(published, {.doubles = true}));
  const std::string large(1 << 20, ' ');
  const Lane& too_large =
      opened_lane("large", large + "bool intersects(const float* a, const float*) { return *a < 1e-3f; }\n");
  EXPECT_TRUE(has_source_as_built(too_large));
  EXPECT_TRUE(small_numbers(too_large).empty());
}

}  // namespace
}  // namespace graze::subjects
