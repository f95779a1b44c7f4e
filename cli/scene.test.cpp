// SPDX-License-Identifier: Apache-2.0
// Scenes as users handle them: measured, edited, drawn from, resumed, named in cases, and refused in one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

class SceneVerb : public CommandTest {
 protected:
  void SetUp() override {
    std::ofstream off(shell.folder / "hills.off");
    off << "OFF\n100 162 0\n";
    for (int i = 0; i < 100; ++i)
      off << 50 + i % 10 * 1.25 << ' ' << i / 10 * 1.5 << ' ' << 200 + (i * i * 7 + i) % 11 * 0.125 << '\n';
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j < 9; ++j) {
        const int v = 10 * i + j;
        off << "3 " << v << ' ' << v + 1 << ' ' << v + 11 << "\n3 " << v << ' ' << v + 11 << ' ' << v + 10 << '\n';
      }
    }
    std::ofstream(shell.folder / "mm.toml") << "extent = [[120000, 120800], [-5400, -5000], [300, 900]]\n"
                                               "edges = [0.5, 40]\nunits = \"mm\"\n";
  }

  Json json(const std::string& file) const { return shell.json(file); }
};

TEST_F(SceneVerb, AMeshBecomesAPageThatIsRead) {
  const Ran ran = shell.done("graze scene hills.off --units mm --out hills.toml");
  EXPECT_TRUE(ran.out.starts_with("Wrote hills.toml: 162 triangles, ")) << ran.out;
  EXPECT_TRUE(ran.out.ends_with("Next: graze fuzz --scene hills.toml\n")) << ran.out;
  const std::string text = shell.file("hills.toml");
  EXPECT_TRUE(
      has(text, {"\nunits = \"mm\"\n", "\nextent = [[50, 61.25], [0, 13.5], [200, 201.125]]\n",
                 "\ngrid = { power_of_two = -3 }\n", "\n[mix]\n", "\n[margins]\n", "\nfiles = [\"hills.off\"]\n"}));
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 100);
  expect_done("graze scene hills.off --units mm > again.toml && cmp hills.toml again.toml");
  expect_done("mkdir sub && graze scene hills.off --out sub/s.toml && grep -q '\"../hills.off\"' sub/s.toml");
  expect_done("graze fuzz --scene sub/s.toml --pairs 300 --strata mesh --lanes 'moller*/f32/cpu' --out sub/c");
  // The scene's pairs, written to a file and measured, have the same sizes.
  expect_done(
      "graze fuzz --scene hills.toml --pairs 1000 --strata mesh --lanes 'moller*/f32/cpu' --out m && "
      "graze dump m --format pairs > m.pairs && graze scene m.pairs --out m.toml && grep -q '^edges' m.toml");
}

TEST_F(SceneVerb, ACampaignInASceneIsRepeatedResumedAndNamed) {
  const std::string fuzz = "graze fuzz --scene hills.toml --pairs 20000 --lanes '*/f32/cpu' ";
  expect_done("graze scene hills.off --out hills.toml");
  expect_out(fuzz + "--threads 1 --out one",
             {"\nLeft out, because the scene cannot contain them:\n  thesis: its triangles have fixed coordinates",
              "\n  extreme_scale: your coordinates stay within 0 … 201.125 units, and your triangles' longest edges "
              "within "});
  expect_out("graze plan --scene hills.toml --pairs 1e6 --lanes 'moller*/f32/cpu'",
             {"\nLeft out, because the scene cannot contain them:\n  thesis: its triangles have fixed coordinates"});
  expect_done(fuzz + "--threads 2 --out two && diff one/summary.json two/summary.json && diff -r one/cases two/cases");
  const Json summary = json("one/summary.json");
  EXPECT_EQ(summary["spec"]["scene"]["left_out"]["far_from_origin"], "your coordinates stay within 0 … 201.125 units");
  for (const char* id : {"near_edge_edge", "shared_edge", "mesh", "mesh_ulps", "mesh_moved"})
    EXPECT_GT(summary["strata"][id]["pairs"], 0) << id;
  // The scene changes the pairs, so a stratum's description says that it is not of them.
  expect_done("graze report one");
  const Json described = json("one/report.json");
  for (const char* rows : {"strata", "groups"}) {
    for (const Json& row : described[rows])
      EXPECT_EQ(row["id"].get<std::string>().starts_with("mesh"),
                !row["describes"].get<std::string>().starts_with("without a scene, "))
          << row;
  }
  // A case's name draws the same pair again, from the file and from the campaign.
  const std::string text = contents(shell.folder / "one" / summary["signatures"][0]["case"].get<std::string>());
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex("stratum=(\\w+) seed=(\\d+) index=(\\d+) scene=(\\S+) ")))
      << text;
  const std::string numbers = ":" + found[2].str() + ":" + found[3].str(), id = found[1].str(), of = found[4].str();
  EXPECT_TRUE(of.starts_with("hills.toml#")) << of;
  const auto vertices_of = [&](const std::string& name) {
    const Ran repro = shell.done("graze repro '" + name + "' --emit obj");
    return repro.out.substr(std::min(repro.out.find("\nv "), repro.out.size()));
  };
  const std::string vertices = vertices_of("one/" + summary["signatures"][0]["case"].get<std::string>());
  EXPECT_GT(vertices.size(), 60u);
  for (const std::string& scene : {of, std::string("hills.toml"), std::string("one")})
    EXPECT_EQ(vertices_of(id + "@" + scene + numbers), vertices) << scene;
  // The verbs that use a campaign accept one in a scene.
  expect_done("graze minimize one > minimised && graze failures one > kinds && graze report one > report");
  EXPECT_TRUE(has(shell.file("one/failures.json"), {"@hills.toml#"}));
  EXPECT_TRUE(has(shell.file("one/report.json"), {"--scene hills.toml --pairs 20000"}));
  const Ran dumped = shell("graze dump one --pairs 40 --format pairs");
  EXPECT_TRUE(has(dumped.out, {"scene=" + of})) << dumped.err;
  // If only a comment is added to the scene, its campaign resumes. If the scene itself changes, so does the campaign,
  // and case names no longer match.
  expect_done("sed -i '1i # mine' hills.toml && " + fuzz + "--out one");
  expect_done("sed -i 's/^units.*/units = \"m\"/' hills.toml");
  const Ran other = shell(fuzz + "--out one");
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, {"cannot use one: it holds another campaign"}));
  expect_error("graze explain '" + id + "@" + of + numbers + "'", 1, {"hills.toml", of});
  EXPECT_EQ(vertices_of(id + "@one" + numbers), vertices);
}

// If a mesh has fewer pairs than its share of the campaign, a message says how many run, and why.
TEST_F(SceneVerb, FewerPairsThanAskedForAreExplained) {
  expect_done("graze scene hills.off --out hills.toml");
  const Ran ran = shell("graze fuzz --scene hills.toml --pairs 20000 --lanes 'moller_1997/f32/cpu' --out few");
  const std::uint64_t pairs = json("few/summary.json")["spec"]["pairs"];
  EXPECT_LT(pairs, 20'000u);
  EXPECT_TRUE(names(ran.err.substr(0, ran.err.size() - 1), {std::to_string(pairs), "20000", "boxes overlap"}));
  EXPECT_EQ(shell("graze fuzz --scene hills.toml --pairs 100 --lanes 'moller_1997/f32/cpu' --out all").err, "");
}

TEST_F(SceneVerb, ThreeLinesAreACampaign) {
  expect_out("graze fuzz --scene mm.toml --pairs 2000 --strata 'near_*,extreme_scale' --lanes '*/f32/cpu' --out c",
             {"  extreme_scale: your coordinates stay within -5400 … 120800 mm, and your triangles' longest "
              "edges within 0.5 … 40\n"});
  EXPECT_EQ(json("c/summary.json")["spec"]["strata"].size(), 4u);
}

TEST_F(SceneVerb, TheExamplesAreDrawnFrom) {
  const std::string root = GRAZE_SOURCE_DIR;
  expect_done("graze fuzz --scene " + root + "/docs/scenes/millimetres.toml --pairs 2000 --lanes '*/f32/cpu' --out mm");
  expect_done("python3 " + root +
              "/scripts/terrain_mesh 16 > terrain.off && graze scene terrain.off --units m --out t.toml");
  const std::string text = shell.file("t.toml");
  EXPECT_TRUE(has(text, {"\nextent = [[0, 400], [0, 400], [128.58, 155.46]]\n", "\ngrid = { decimals = 2 }\n",
                         "\ncontent = \"3794dafeca051a06\"\n"}));  // hash of the script's output
}

TEST_F(SceneVerb, PosesAndSeveralMeshes) {
  expect_done("printf '1,0,0,0,0,1,0,0,0,0,1,0\\n1,0,0,0.5,0,1,0,0.25,0,0,1,0.125\\n' > p.csv");
  expect_done("graze scene hills.off --poses p.csv --out p.toml && grep -q '^poses = \"p.csv\"' p.toml");
  expect_done("graze fuzz --scene p.toml --pairs 500 --strata 'mesh*' --lanes 'moller*/f32/cpu' --out p");
  expect_done(
      "cp hills.off b.off && graze scene hills.off b.off --out two.toml && grep -q '\"hills.off\", \"b.off\"' "
      "two.toml");
  expect_error("graze scene hills.off b.off --poses p.csv", 2, {"--poses", "2"});
}

// Whichever lane is measured as the cheapest, a fresh campaign shows that it suffices.
TEST_F(SceneVerb, WhatSufficesKeepsTheRateInAFreshCampaign) {
  for (const std::string measured : {"hills.off --out s.toml", "mm.toml"}) {
    const Ran ran = shell.done("graze scene " + measured + " --sufficient 0.05 | tr '\\n' ' '");
    EXPECT_TRUE(has(ran.out, {"Wrong on at most 0.05 of this scene's pairs: use ", "exact/f32/cpu",
                              "far_from_origin: your coordinates"}));
    const std::regex lane("(?:: use|suffices is) (\\w+/f(?:32|64)/cpu(?:/[^ ,]+[0-9])?)[,:]");
    int checked = 0;
    for (std::sregex_iterator at(ran.out.begin(), ran.out.end(), lane), end; at != end; ++at) {
      const std::string id = (*at)[1], out = fmt::format("c{}", ++checked);
      if (id.starts_with("exact")) continue;
      expect_done("rm -rf " + out + "; graze fuzz --scene " + (measured == "mm.toml" ? "mm" : "s") +
                  ".toml --pairs 40000 --seed 77 --lanes '" + id + "' --out " + out);
      std::uint64_t pairs = 0, wrong = 0;
      const Json summary = json(out + "/summary.json");
      for (const auto& [stratum, row] : summary["strata"].items()) {
        pairs += row["pairs"].get<std::uint64_t>();
        const Json& counts = row["lanes"].at(id);
        wrong += counts["false_positive"].get<std::uint64_t>() + counts["false_negative"].get<std::uint64_t>();
      }
      EXPECT_LE(static_cast<double>(wrong), 0.05 * static_cast<double>(pairs)) << id;
    }
    EXPECT_GE(checked, 2) << ran.out;
  }
}

TEST_F(SceneVerb, WrongUseIsOneLine) {
  expect_error("graze scene missing.off", 1, {"missing.off", "No such file or directory"});
  expect_error("cp hills.off $'\\xff.off'; graze scene $'\\xff.off'", 2, {"UTF-8"});
  expect_error(
      "printf '1 0 0 0 0 1 0 0 0 0 1 0\\n1 0 0 9e37 0 1 0 0 0 0 1 0\\n' > p.csv; graze scene hills.off --poses p.csv",
      1, {"hills.off"});
  expect_error("graze scene mm.toml", 2, {"meshes or pairs", "--sufficient"});
  expect_error("graze scene mm.toml hills.off --sufficient 0.1", 2, {"meshes or pairs", "--sufficient"});
  expect_error("graze scene hills.off --sufficient 0.1", 2, {"--sufficient", "--out"});
  expect_error("graze scene mm.toml --sufficient 1", 2, {"--sufficient", "1"});
  expect_error("graze fuzz --scene missing.toml", 1, {"missing.toml", "No such file or directory"});
  expect_error("graze fuzz --scene .", 1, {".", "Is a directory"});
  expect_error("printf 'extent = [0, 1]\\nedges = [1, nan]\\n' > bad.toml; graze fuzz --scene bad.toml", 1,
               {"bad.toml:2"});
  expect_error("printf 'extnt = [0, 1]\\n' > bad.toml; graze fuzz --scene bad.toml", 1, {"'extent'"});
  expect_error("graze fuzz --scene mm.toml --strata 'nearly_*'", 2, {"'nearly_*'"});
  expect_error("graze fuzz --scene mm.toml --strata thesis", 2, {"thesis", "fixed coordinates"});
  expect_error("graze fuzz --scene mm.toml --mesh hills.off", 2, {"--scene"});
  expect_error(
      "graze scene hills.off --out hills.toml > /dev/null; sed -i '$d' hills.off; echo 3 0 1 3 >> hills.off; graze "
      "fuzz "
      "--scene hills.toml",
      1, {"hills.off"});
  expect_error("graze explain near_edge_edge@mm.toml:x:1", 2, {"whole number", "'x'"});
}

}  // namespace
}  // namespace graze::cli
