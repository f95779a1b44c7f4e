// SPDX-License-Identifier: Apache-2.0
// Tests snippets as text. Also runs the Python snippet, which tests 32 axes, over the whole corpus, and compares it
// with the oracle. cli/emit.test.cpp compiles and runs the other snippets.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "corpus/pair_format.h"
#include "oracle/truth.h"
#include "reports/snippet.h"

namespace graze::reports {
namespace {

TEST(Snippet, HoldsTheAlgorithmsOwnSource) {
  for (const Lane& lane : published_lanes()) {
    const std::string id(lane.info->id), source = amalgamated_source(id);
    EXPECT_EQ(source.find("#include \""), source.npos) << id;
    std::ifstream in(std::filesystem::path(GRAZE_SOURCE_DIR) / "core/algorithms" / (id + ".h"), std::ios::binary);
    const std::string header{std::istreambuf_iterator<char>(in), {}};
    const std::size_t body = header.find("namespace graze {");
    ASSERT_NE(body, header.npos) << id;
    EXPECT_NE(source.find(header.substr(body)), source.npos) << id << ": not the file in core/, byte for byte";
  }
}

TEST(Snippet, HoldsNothingItDoesNotNeed) {
  // An AlgorithmInfo begins with its algorithm's id in quotes. A source must contain only its own algorithm's id.
  for (const Lane& lane : published_lanes()) {
    const std::string source = amalgamated_source(lane.info->id);
    for (const Lane& other : published_lanes())
      EXPECT_EQ(source.find(fmt::format("\"{}\"", other.info->id)) != source.npos, other.info == lane.info)
          << other.info->id << " in " << lane.info->id;
  }
  EXPECT_NE(amalgamated_source("guigue_devillers_2003").find("Vec2<Real> drop("), std::string::npos);
  EXPECT_EQ(amalgamated_source("separating_axes").find("struct Plane"), std::string::npos);
}

TEST(Snippet, ANameCannotEndItsComment) {
  SnippetCase found{"x\nsystem(\"rm\")\r#", Pair{}, Verdict::intersects, find_lane("projected_sat/f32/cpu"),
                    Verdict::disjoint};
  for (std::size_t k = 0; k < std::size(kSnippetKinds); ++k) {
    const auto kind = static_cast<SnippetKind>(k);
    if (kind == SnippetKind::cuda) found.lane = find_lane("projected_sat/f32/cuda-fma");
    const std::string text = snippet(kind, found);
    found.lane = find_lane("projected_sat/f32/cpu");
    EXPECT_NE(text.find("x?system(\"rm\")?#"), std::string::npos) << kSnippetKinds[k];
    EXPECT_EQ(text.find('\r'), std::string::npos);
  }
}

TEST(Snippet, ObjDecimalsReadAsTheSameBits) {
  const float numbers[] = {0x1p-149f, 0x1.fffffep+127f, -0.0f, 0x1.fffffcp-127f, 16777217.0f, 0x1.99999ap-4f, 1 / 3.0f};
  for (const float x : numbers) {
    Pair pair{};
    coordinates(pair)[0] = x;
    std::istringstream text(snippet(SnippetKind::obj, {"c", pair, Verdict::disjoint, nullptr, Verdict::disjoint}));
    std::string line;
    while (std::getline(text, line) && !line.starts_with("v ")) {
    }
    const std::string word = line.substr(2, line.find(' ', 2) - 2);
    const float once = std::strtof(word.c_str(), nullptr),
                twice = static_cast<float>(std::strtod(word.c_str(), nullptr));
    EXPECT_EQ(corpus::hex_float(once), corpus::hex_float(x)) << line;
    EXPECT_EQ(corpus::hex_float(twice), corpus::hex_float(x)) << line;
  }
}

// The corpus has every kind of contact between triangles, segments and points: in space, in one plane and on one line.
// Each of its finite float32 pairs is tested.
TEST(Snippet, PythonDecidesTheWholeCorpus) {
  if (std::system("python3 -c '' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "graze-python-snippets";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  int count = 0, disjoint = 0;
  for (const auto& item : std::filesystem::recursive_directory_iterator(GRAZE_SOURCE_DIR "/corpus")) {
    if (item.path().extension() != ".pairs") continue;
    for (const corpus::Entry& entry : corpus::read_pairs(item.path(), PairTypes::both)) {
      if (entry.doubles) continue;  // snippets show pairs of float32
      const oracle::Truth t = oracle::truth(entry.pair);
      if (t.verdict == Verdict::declined) continue;
      disjoint += t.verdict == Verdict::disjoint;
      std::ofstream(folder / (std::to_string(count++) + ".py"))
          << snippet(SnippetKind::python, {*field(entry, "name"), entry.pair, t.verdict, nullptr, t.verdict});
    }
  }
  ASSERT_GT(count, 100);
  ASSERT_GT(disjoint, 30);
  // One interpreter runs all snippets. A snippet exits with status 0 if it agrees with the given truth.
  std::ofstream(folder / "all.driver") << "import glob, runpy, sys\n"
                                          "wrong = 0\n"
                                          "for f in glob.glob(sys.argv[1] + '/*.py'):\n"
                                          "    try: runpy.run_path(f)\n"
                                          "    except SystemExit as e:\n"
                                          "        if e.code: wrong += 1; print(f, file=sys.stderr)\n"
                                          "    else: wrong += 1\n"
                                          "sys.exit(wrong != 0)\n";
  const std::string command =
      "python3 '" + (folder / "all.driver").string() + "' '" + folder.string() + "' > /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

// The program must reject a false truth, which shows that it really decides.
TEST(Snippet, PythonContradictsAWrongTruth) {
  if (std::system("python3 -c '' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "graze-wrong-truth.py";
  const Pair pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 2, 4}, {2, 1, 4}}};
  for (const Verdict claimed : {Verdict::intersects, Verdict::disjoint}) {
    std::ofstream(file) << snippet(SnippetKind::python, {"c", pair, claimed, nullptr, claimed});
    const int rc = std::system(("python3 '" + file.string() + "' > /dev/null").c_str());
    EXPECT_EQ(rc == 0, claimed == Verdict::intersects);
  }
}

}  // namespace
}  // namespace graze::reports
