// SPDX-License-Identifier: Apache-2.0
// `graze map` as users run it, and the maps that `graze minimize` stores for a report.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class MapCommand : public CommandTest {};

TEST_F(MapCommand, CountsAndDrawsATruthThatALineCuts) {
  std::ofstream(shell.folder / "edge.pairs") << "0 0 0 1 1 0 1 0 0  .75 .75 0 .75 .75 1 .5 .75 1\n";
  const Ran ran = shell.done("graze map edge.pairs --lanes '*/f32/cpu' --x 'b[0].x' --y 'b[0].y' --out edge.png");
  EXPECT_TRUE(has(ran.out, {"edge.pairs:1: 256 x 256 cells, b[0].x to the right and b[0].y upwards"}));
  EXPECT_FALSE(has(ran.out, {"along which verdicts changed most"}));
  const std::size_t truth = ran.out.find("truth ");
  ASSERT_NE(truth, std::string::npos) << ran.out;
  const std::string line = ran.out.substr(truth, ran.out.find('\n', truth) - truth);
  EXPECT_TRUE(has(line, {"32,640"}));  // 256 * 255 / 2
  EXPECT_TRUE(has(line, {"32,896"}));
  EXPECT_EQ(shell.file("edge.png").substr(1, 3), "PNG");
}

TEST_F(MapCommand, SameBytesTwiceAndAPictureAPanelInADirectory) {
  expect_done(
      "graze map near_edge_edge:1:7 --lanes 'moller_1997/f32/*' --out a.png > a && "
      "graze map near_edge_edge:1:7 --lanes 'moller_1997/f32/*' --out b.png > b && cmp a.png b.png && "
      "sed s/b.png/a.png/ b | cmp a");
  expect_done(
      "graze map near_edge_edge:1:7 --lanes 'moller_1997/f32/cpu,exact/*' --out panels && "
      "test \"$(cd panels; echo *)\" = 'moller_1997-f32-cpu.png truth.png'");
  // Panels of another case are removed; other pictures are kept.
  expect_done(
      "printf 'a picture of mine' > panels/mine.png && "
      "graze map near_edge_edge:1:8 --lanes 'projected_sat/f32/cpu' --out panels && "
      "test \"$(cd panels; echo *)\" = 'mine.png projected_sat-f32-cpu.png truth.png'");
}

TEST_F(MapCommand, BadInputGetsOneLine) {
  std::ofstream(shell.folder / "nan.pairs") << "nan 0 0 1 1 0 1 0 0  .75 .75 0 .75 .75 1 .5 .75 1\n";
  std::ofstream(shell.folder / "file");
  using Words = std::vector<std::string>;
  for (const auto& [arguments, status, words] :
       {std::tuple{"", 2, Words{"CASE"}},
        {"missing.pairs", 1, {"missing.pairs", "No such file or directory"}},
        {"nan.pairs", 1, {"nan.pairs", "not finite"}},
        {"lattice:1:1 --lanes nothing", 2, {"'nothing'"}},
        {"lattice:1:1 --x 'b[0].x'", 2, {"--x", "--y"}},
        {"lattice:1:1 --x 'b[0].x' --y 'b[0].x'", 2, {"--x", "--y", "b[0].x"}},
        {"lattice:1:1 --x 'b[0].x' --y 'b[3].x'", 2, {"--y", "'b[3].x'", "a[0].x", "b[2].z"}},
        {"lattice:1:1 --out file", 1, {"file", "Not a directory"}},
        {"lattice:1:1 --out no/where.png > /dev/null", 1, {"no/where.png", "No such file or directory"}}}) {
    expect_error(std::string("graze map ") + arguments, status, words);
  }
}

TEST_F(MapCommand, MinimizeStoresTheMapsOfCardsOnceAndForItsPairs) {
  expect_done(
      "graze fuzz --seed 2 --pairs 120 --lanes '*/f32/*' --executor twin --strata near_edge_edge --out one > /dev/null "
      "&& cp -r one two && graze minimize one --threads 1 > /dev/null && graze minimize two --threads 4 > /dev/null && "
      "diff -r one/cases two/cases");
  std::size_t maps = 0;
  for (const auto& file : std::filesystem::directory_iterator(shell.folder / "one/cases")) {
    if (!file.path().filename().string().ends_with(".maps.json")) continue;
    ++maps;
    const auto json = nlohmann::json::parse(contents(file.path()));
    EXPECT_EQ(json["panels"][0]["name"], "truth");
    EXPECT_EQ(json["panels"].size(), 6u)
        << file.path();  // the truth, and one algorithm's f32 lanes that need no device
  }
  EXPECT_GT(maps, 10u);
  EXPECT_LE(maps, 40u);
  // Current maps are kept; missing maps and maps of another pair are made again.
  expect_done(
      "cp -r one/cases before; touch -d 2000-01-01 one/cases/*.maps.json; set -- one/cases/*.maps.json; rm $1; cp $2 "
      "$3; "
      "graze minimize one > /dev/null && diff -r one/cases before && "
      "test $(find one/cases -name '*.maps.json' -newermt 2001-01-01 | wc -l) = 2");
}

}  // namespace
}  // namespace graze::cli
