// SPDX-License-Identifier: Apache-2.0
// `graze view` as users run it; reports/web/tests/viewer.spec.ts tests its page in a browser.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/run_graze.h"
#include "reports/viewer.h"

namespace graze::cli {
namespace {

class ViewCommand : public CommandTest {
 protected:
  void SetUp() override {
    if (!reports::has_viewer())
      GTEST_SKIP() << "this build has no viewer: it takes Node and a compiler for WebAssembly";
  }

  // Returns the data in the page.
  nlohmann::json data(const std::string& page) const {
    const std::string text = shell.file(page), start = "<script type=\"application/json\" id=\"view\">";
    const std::size_t begin = text.find(start) + start.size();
    return nlohmann::json::parse(text.substr(begin, text.find("</script>", begin) - begin));
  }
};

TEST_F(ViewCommand, OnePageOfFewMegabytesThatNamesNoOtherFile) {
  const Ran ran = shell.done("graze view thesis:1:0");
  EXPECT_EQ(ran.out, "Wrote view.html: 1 pair\n");
  const std::string page = shell.file("view.html");
  EXPECT_LT(page.size(), std::size_t{4} << 20);
  EXPECT_FALSE(has(page, {" src="}));
  const nlohmann::json held = data("view.html");
  EXPECT_EQ(held["pairs"][0]["name"], "thesis:1:0");
  EXPECT_EQ(held["pairs"][0]["bits"].get<std::string>().substr(0, 24), "40000000c000000040800000");  // 2 -2 4
}

TEST_F(ViewCommand, CodeIsRefusedIfThePageStoresNoPair) {
  expect_done("printf 'int intersects(const float* a, const float* b) { return a[0] < b[0]; }' > m.c");
  for (const char* random : {"", "--random 5 "})
    expect_error(std::string("graze view --subject m=./m.c --out none.html ") + random, 2, {"--subject"});
  expect_done("test ! -e none.html && graze view thesis_special:1:0 --subject m=./m.c");
}

TEST_F(ViewCommand, RefusesNumbersAsOtherVerbsDo) {
  std::ofstream(shell.folder / "near.pairs")
      << "0 0 1 1 0 1 0 1 1  0 0 1.00000000001 1 0 1.00000000001 0 1 1.00000000001\n";
  for (const char* what : {"near.pairs", "."})
    expect_error(std::string("graze view --exact-input --out v.html ") + what, 2, {"near.pairs:1", "--exact-input"});
  expect_error("graze view --exact-input", 2, {"--exact-input", "WHAT"});
  std::ofstream(shell.folder / "less.pairs")
      << "0x1p-100000 0 0  1 0 0  0 1 0   0 0 1  1 0 1  0 1 1 | coordinates=f64\n";
  expect_error("graze view less.pairs", 1, {"less.pairs:1", "exponent", "0x1p-100000"});
}

TEST_F(ViewCommand, StoredVerdictsOfAllLanesCanariesAmongThem) {
  expect_done("graze view --out all.html");
  const nlohmann::json replay = data("all.html")["replay"];
  EXPECT_EQ(replay["lanes"].size(), 32u);
  EXPECT_GT(replay["pairs"].size(), 300u);
  int differ = 0;
  for (const nlohmann::json& pair : replay["pairs"]) {
    EXPECT_EQ(pair["verdicts"].get<std::string>().size(), replay["lanes"].size());
    differ += pair["verdicts"].get<std::string>().find_first_not_of(pair["verdicts"].get<std::string>()[0]) !=
              std::string::npos;
  }
  EXPECT_GT(differ, 30);
}

TEST_F(ViewCommand, FilesFoldersAndMeshes) {
  std::ofstream(shell.folder / "two.pairs") << "0 0 0 1 1 0 1 0 0  .75 .75 0 .75 .75 1 .5 .75 1\n"
                                               "0 0 0 1 1 0 1 0 0  .75 .75 1 .75 .75 2 .5 .75 2 | name=above\n";
  std::ofstream(shell.folder / "mesh.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.3 0.3 -1\nv 0.3 0.3 1\nv 2 2 0.5\nf 1 2 3\nf 4 5 6\n";
  EXPECT_EQ(shell("graze view two.pairs").out, "Wrote view.html: 2 pairs\n");
  EXPECT_EQ(data("view.html")["pairs"][1]["name"], "above");
  expect_done("mkdir -p some && cp two.pairs some/a.pairs && cp two.pairs some/b.pairs");
  EXPECT_EQ(shell("graze view some").out, "Wrote view.html: 4 pairs\n");
  EXPECT_EQ(shell("graze view mesh.obj --out mesh.html").out, "Wrote mesh.html: 1 pair, 2 triangles\n");
  expect_done(
      "graze fuzz --pairs 200 --strata thesis,near_edge_edge --lanes '*/f32/cpu' --out run && graze view run --out "
      "run.html");
  EXPECT_GT(data("run.html")["pairs"].size(), 3u);
  std::ofstream(shell.folder / "small.pairs")
      << "0 0 0 1 1 0 1 0 0  .75 .75 0 .75 .75 1 .5 .75 1 | kind=minimised from=mesh:1:597\n";
  expect_done("graze view small.pairs --out small.html");
  EXPECT_EQ(data("small.html")["pairs"][0]["name"], "minimised from mesh:1:597");
}

// Shows a query with all triangles at once, from the arguments of `graze query` or from the hits that it writes.
TEST_F(ViewCommand, QueriesAndTheirResults) {
  std::ofstream(shell.folder / "tent.obj")
      << "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 3 1 -1\nv 3 1 1\nv 4 2 1\nf 1 3 4\nf 1 2 3\nf 5 6 7\n";
  std::ofstream(shell.folder / "ref.txt") << "3 1 0  3 2 2  4 1 2\n";
  EXPECT_EQ(shell("graze view ref.txt tent.obj").out, "Wrote view.html: 2 pairs, 3 triangles\n");
  nlohmann::json held = data("view.html");
  EXPECT_EQ(held["opens"], "triangles");
  EXPECT_EQ(held["title"], "hits of ref.txt in tent.obj");
  EXPECT_EQ(held["ids"], (std::vector<int>{1, 2, 0}));
  EXPECT_EQ(held["pairs"][0]["name"], "tent.obj, triangle 1");
  EXPECT_EQ(held["pairs"][0]["bits"].get<std::string>().substr(72),
            held["triangles"][0].get<std::string>());  // hits come first
  EXPECT_EQ(held["pairs"][1]["bits"].get<std::string>().substr(72), held["triangles"][1].get<std::string>());
  expect_done("graze query ref.txt tent.obj --pairs hits.pairs --obj hits.obj");
  EXPECT_EQ(shell("graze view hits.pairs").out, "Wrote view.html: 2 pairs, 2 triangles\n");
  EXPECT_EQ(data("view.html")["opens"], "triangles");
  EXPECT_EQ(shell("graze view hits.obj#0 hits.obj").out, "Wrote view.html: 3 pairs, 3 triangles\n");
  EXPECT_EQ(shell("echo 9 9 9 9 8 9 8 9 9 > far.txt; graze view far.txt tent.obj").out,
            "Wrote view.html: 1 pair, 3 triangles\n");
  expect_error("echo 9 9 9 9 8 9 8 9 9 >> ref.txt; graze view ref.txt tent.obj", 1, {"ref.txt", "2"});
  expect_error("graze view far.txt no.obj", 1, {"no.obj", "No such file or directory"});
  expect_done("graze view thesis:1:0");
  EXPECT_EQ(data("view.html")["opens"], "pair");
}

// Each pair keeps its type; if one is a pair of doubles, the page shows all as doubles.
TEST_F(ViewCommand, PairsOfDoublesAsTheyAre) {
  const std::string apart =
      "1000000.01 0 0 1000000.01 1 0 1000000.01 0 1  1000000.02 0 0 1000000.02 1 0 1000000.02 0 1";
  const std::string bits = "412e848005";  // the first bits of 1000000.01 and of 1000000.02
  const auto shows_doubles = [&](const std::string& command, std::size_t pairs) {
    expect_done("graze view " + command + " --out d.html");
    const nlohmann::json held = data("d.html");
    EXPECT_EQ(held["coordinates"], "f64") << command;
    EXPECT_EQ(held["pairs"].size(), pairs) << command;
    EXPECT_EQ(held["pairs"][0]["bits"].get<std::string>().size(), 288u) << command;
    const nlohmann::json lanes = held["replay"]["lanes"];
    EXPECT_NE(std::find(lanes.begin(), lanes.end(), "exact/f64/cpu"), lanes.end()) << command;
    EXPECT_EQ(held["replay"]["pairs"][0]["bits"].get<std::string>().size(), 288u) << command;
    return held;
  };
  std::ofstream(shell.folder / "both.pairs") << "0 0 0 1 1 0 1 0 0  .75 .75 0 .75 .75 1 .5 .75 1\n"
                                             << apart << " | coordinates=f64\n";
  std::ofstream(shell.folder / "far.off") << "OFF\n6 2 0\n1000000.01 0 0\n1000000.01 1 0\n1000000.01 0 1\n"
                                             "1000000.02 0 0\n1000000.02 1 0\n1000000.02 0 1\n3 0 1 2\n3 3 4 5\n";
  const nlohmann::json both = shows_doubles("both.pairs", 2);
  EXPECT_EQ(both["pairs"][0]["bits"].get<std::string>().substr(48, 32), "3ff00000000000003ff0000000000000");
  EXPECT_EQ(both["pairs"][1]["bits"].get<std::string>().substr(0, 10), bits);
  shows_doubles("uniform/f64:1:2", 1);
  const nlohmann::json mesh = shows_doubles("far.off", 1);
  EXPECT_EQ(mesh["triangles"][0].get<std::string>().substr(0, 10), bits);
  EXPECT_EQ(mesh["triangles"][0].get<std::string>().size(), 144u);
  const nlohmann::json query = shows_doubles("far.off#0 far.off", 1);
  EXPECT_EQ(query["ids"], (std::vector<int>{0, 1}));  // its only hit is itself
  const Ran said = shell("graze view far.off");
  EXPECT_TRUE(has(said.err, {"far.off: decided in doubles"}));
  for (const char* what : {"far.off", "far.off#0 far.off"})
    expect_error(std::string("graze view --exact-input --out e.html ") + what, 2, {"float32", "6 of", "--exact-input"});
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "e.html"));
}

// The user's code in double gets the doubles; code in float gets them rounded to float32.
TEST_F(ViewCommand, OwnCodeIsAskedAboutDoubles) {
  std::ofstream(shell.folder / "mine.c") << "int meet(const double* a, const double* b) { return a[0] == b[0]; }\n"
                                            "int meet_f(const float* a, const float* b) { return a[0] == b[0]; }\n";
  const std::string campaign =
      "graze fuzz --coordinates f64 --strata large_offset --pairs 200 --lanes 'mine/*,exact/*' ";
  for (const auto& [function, verdict] :
       std::map<std::string, std::string>{{"meet", "disjoint"}, {"meet_f", "intersects"}}) {
    const std::string subject = "--subject mine=mine.c:" + function;
    std::ofstream(shell.folder / "far.txt")
        << "1000000.01 0 0 1000000.01 1 0 1000000.01 0 1 1000000.02 0 0 1000000.02 1 0 "
           "1000000.02 0 1 | coordinates=f64\n";
    expect_done("graze view far.txt " + subject + " --out o.html");
    const nlohmann::json said = data("o.html")["pairs"][0]["said"][0];
    EXPECT_EQ(said["verdict"], verdict) << said;
    EXPECT_EQ(said["wrong"], verdict == "intersects") << said;
    expect_done(campaign + subject + " --out " + function + " && graze view " + function + " --out c.html");
    const nlohmann::json held = data("c.html");
    EXPECT_EQ(held["coordinates"], "f64");
    EXPECT_GT(held["pairs"].size(), 0u);
    EXPECT_GT(held["pairs"][0]["said"].size(), 0u);
  }
}

TEST_F(ViewCommand, BeginsWithRandomTrianglesOf2012) {
  EXPECT_EQ(shell("graze view --random 12").out, "Wrote view.html: 12 random triangles of 2012\n");
  EXPECT_EQ(data("view.html")["random"], 12);
  EXPECT_EQ(data("view.html")["opens"], "random");
  EXPECT_EQ(shell("graze view --random 1").out, "Wrote view.html: 1 random triangle of 2012\n");
  expect_error("graze view --random 0", 2, {"--random", "0"});
  expect_error("graze view --random 5001", 2, {"--random", "5001"});
  expect_error("graze view thesis:1:0 --random 5", 2, {"--random", "WHAT"});
}

TEST_F(ViewCommand, BadInputGetsOneLine) {
  std::filesystem::create_directory(shell.folder / "empty");
  std::ofstream(shell.folder / "flat.off") << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::ofstream(shell.folder / "words.pairs") << "one two\n";
  using Words = std::vector<std::string>;
  for (const auto& [arguments, status, words] :
       {std::tuple{"missing.pairs", 1, Words{"missing.pairs", "No such file or directory"}},
        {"empty", 1, {"empty", "*.pairs"}},
        {"flat.off", 1, {"flat.off", "boxes"}},
        {"words.pairs", 1, {"words.pairs:1"}},
        {"nowhere:1:1", 2, {"'nowhere'"}},
        {"lattice:1:x", 2, {"lattice:1:x", "'x'"}},
        {"lattice:1:1 --out empty", 1, {"empty", "Is a directory"}}}) {
    expect_error(std::string("graze view ") + arguments, status, words);
  }
}

// With a display, the substitute for xdg-open opens the page; without one, nothing does.
TEST_F(ViewCommand, OpensThePageOnlyWhereThereIsADisplay) {
  expect_done("printf '#!/bin/sh\\necho \"$1\" >> opened\\n' > xdg-open && chmod +x xdg-open");
  expect_done("unset DISPLAY WAYLAND_DISPLAY; PATH=$PWD:$PATH graze view --out a.html && test ! -e opened");
  expect_done("DISPLAY=:0 PATH=$PWD:$PATH graze view --out a.html && test \"$(cat opened)\" = a.html");
}

}  // namespace
}  // namespace graze::cli
