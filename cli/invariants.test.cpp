// SPDX-License-Identifier: Apache-2.0
// `graze invariants` as users run it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class InvariantsCommand : public CommandTest {};

TEST_F(InvariantsCommand, LeavesTheSameBytesWhateverTheThreads) {
  const std::string run =
      "graze invariants --lanes '*/f32/cpu,moller_1997/f32/cuda-fma' --strata 'near_*' --pairs 600 ";
  const Ran first = shell(run + "--threads 1 --out one"), second = shell(run + "--threads 3 --out three");
  ASSERT_EQ(first.status, 0) << first.err;
  ASSERT_EQ(second.status, 0) << second.err;
  expect_done("diff -r one three");
  const auto json = shell.json("one/invariants.json");
  EXPECT_EQ(json["truth"]["pairs"], 600);
  for (const auto& lane : json["lanes"]) {
    const bool exact = lane["lane"] == "exact/f32/cpu";
    for (const auto& [invariant, of] : lane["invariants"].items()) {
      EXPECT_EQ(of["case"].is_null(), of["changed"] == 0) << lane["lane"] << invariant;
      std::uint64_t pairs = 0, changed = 0;
      for (const auto& [stratum, counts] : of["strata"].items()) {
        pairs += counts["pairs"].get<std::uint64_t>();
        changed += counts["changed"].get<std::uint64_t>();
      }
      EXPECT_EQ(of["pairs"], pairs);
      EXPECT_EQ(of["changed"], changed);
      if (exact) {
        EXPECT_EQ(of["changed"], 0) << invariant;
      }
    }
    EXPECT_TRUE(has(first.out, {lane["lane"].get<std::string>()}));
  }
  EXPECT_GT(json["lanes"][0]["invariants"]["order"]["changed"], 0);
}

// Besides the effect of all scalings together, the file and the table list that of each factor, such as 2.
TEST_F(InvariantsCommand, TellsWhatEachScalingChangesAlone) {
  const std::string invariants =
      "graze invariants --lanes 'projected_sat/f32/cpu' --strata near_edge_edge --pairs 500 --out l";
  const Ran ran = shell.done(invariants);
  const auto of = shell.json("l/invariants.json")["lanes"][0]["invariants"];
  EXPECT_FALSE(of["order"].contains("by_factor"));
  const auto& factors = of["scale"]["by_factor"];
  ASSERT_EQ(factors.size(), 8u);
  std::string line = "projected_sat/f32/cpu";
  for (const auto& factor : factors) {
    EXPECT_EQ(factor["pairs"], 500);
    EXPECT_LE(factor["in_range"], of["scale"]["in_range"]);
    char cell[32];
    std::snprintf(cell, sizeof cell, " +%.3g0*", factor["in_range"].get<double>() / 5);
    line += cell;
  }
  EXPECT_EQ(factors[0]["log2"], 1);
  EXPECT_LT(factors[0]["in_range"].get<int>() * 2, of["scale"]["in_range"].get<int>());
  EXPECT_EQ(shell(invariants + " | grep -cE '" + line + "$'").out, "1\n") << line << '\n' << ran.out;
}

// The lane is wrong on the first pair of each invariant's case file, which explain and minimize accept.
TEST_F(InvariantsCommand, ItsCasesAreWrongVerdicts) {
  expect_done("graze invariants --lanes 'guigue*/f32/cpu' --strata 'near_*' --pairs 400 --out l");
  for (const char* invariant : {"order", "mirror", "axes"}) {
    const std::string file = std::string("l/cases/") + invariant + ".pairs";
    const Ran checked = shell("graze check " + file + " --json --lanes 'guigue*/f32/cpu' | head -n 1");
    const auto line = nlohmann::json::parse(checked.out);
    EXPECT_NE(line["truth"]["verdict"], line["lanes"]["guigue_devillers_2003/f32/cpu"]) << invariant;
    expect_out("graze explain " + file + " --lanes 'guigue*/f32/cpu'", {"guigue_devillers_2003/f32 (cpu) says"});
    expect_done("graze minimize " + file + " --lanes 'guigue*/f32/cpu' --out small.pairs");
  }
}

// A subject whose verdict depends on the order of the triangles, and a published lane in a scene.
TEST_F(InvariantsCommand, OfOnesOwnCodeAndWithinAScene) {
  std::ofstream(shell.folder / "mine.c") << "int mine(const float a[9], const float b[9]) { return a[0] > b[0]; }\n";
  expect_done("cc -shared -fPIC mine.c -o mine.so");
  expect_done("graze invariants --subject mine=mine.so:mine --lanes 'mine/*' --strata uniform --pairs 200 --out l");
  const auto of = shell.json("l/invariants.json")["lanes"][0]["invariants"];
  EXPECT_EQ(of["swap"]["changed"], 200);  // a[0] > b[0] holds in one order only
  EXPECT_EQ(of["scale"]["changed"], 0);
  EXPECT_EQ(of["translate"]["changed"], 0);
  std::ofstream(shell.folder / "hall.toml") << "extent = [[100, 108], [0, 4], [0, 4]]\nedges = [0.5, 1, 2]\n";
  expect_done("graze invariants --lanes 'moller*/f32/cpu' --scene hall.toml --pairs 100 --out l");
  EXPECT_EQ(shell.json("l/invariants.json")["scene"], "hall.toml");
}

TEST_F(InvariantsCommand, BadUseIsOneLine) {
  expect_error("graze invariants --lanes nothing --out l", 2, {"'nothing'", "graze lanes"});
  expect_error("graze invariants --strata nothing --out l", 2, {"'nothing'", "graze strata"});
  expect_error("touch l && graze invariants --pairs 10 --out l", 1, {"l", "Not a directory"});
}

}  // namespace
}  // namespace graze::cli
