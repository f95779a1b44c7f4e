// SPDX-License-Identifier: Apache-2.0
// Policies as users handle them: lanes under a policy with every verb, `graze tune` and `graze pareto`.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class Policies : public CommandTest {};
class TuneCommand : public CommandTest {};
class AgreeCommand : public CommandTest {};
class ParetoCommand : public CommandTest {};

TEST_F(Policies, AreLanesOnEveryVerb) {
  const std::string lanes =
      " --lanes 'moller_1997/f32/cpu,moller_1997/f32/cpu/paper,moller_1997/f32/cuda-fma/rel:16,"
      "moller_1997/f64/cpu/plane_distance=abs:1e-6,separation=rel:2,moller_1997/f32/cpu/bound'";
  std::ofstream(shell.folder / "small.pairs") << "0 0 0 .01 0 0 0 .01 0  0 0 .005 .01 0 .005 0 .01 .005\n";
  const Ran check = shell("graze check small.pairs" + lanes);
  EXPECT_TRUE(has(check.out, {"moller_1997/f32 paper"})) << check.err;
  EXPECT_TRUE(has(check.out, {"moller_1997/f64 plane_distance=abs:1e-6,separation=rel:2"}));
  const Ran explained = shell("graze explain small.pairs" + lanes);
  EXPECT_TRUE(has(explained.out, {"experiment: without paper it is right"})) << explained.err;
  expect_done("graze fuzz --strata 'near_vertex_face,shared_edge,extreme_scale' --pairs 900 --out c" + lanes +
              " > fuzz");
  const auto summary = shell.json("c/summary.json");
  EXPECT_EQ(summary["spec"]["lanes"].size(), 5u);
  EXPECT_GT(summary["strata"]["extreme_scale"]["lanes"]["moller_1997/f32/cpu/paper"]["false_positive"], 50);
  EXPECT_EQ(summary["strata"]["extreme_scale"]["lanes"]["moller_1997/f32/cpu/bound"]["false_positive"], 0);
  expect_done("graze minimize c && graze failures c > kinds && graze report c && graze dump c > /dev/null");
  EXPECT_TRUE(has(shell.file("kinds"), {"moller_1997: policy"}));
  // Emits a case of a lane under a policy as a program.
  const Ran emitted = shell(
      "graze repro small.pairs --lanes moller_1997/f32/cpu/paper --emit cpp > case.cpp && g++ -std=c++20 -O2 "
      "-ffp-contract=off case.cpp -o case && ./case");
  EXPECT_TRUE(has(emitted.out, {"moller_1997/f32: intersects; truth: disjoint"})) << emitted.err;
  expect_done("graze lanes --lanes 'moller_1997/f32/cpu/rel:8' | grep 'rel:8 *available'");
  expect_done("graze map small.pairs --lanes moller_1997/f32/cpu/paper --out map.png");
}

TEST_F(Policies, RefusedOnesGetOneLine) {
  expect_error("graze repro uniform:1:1 --lanes 'moller_1997/f32/cpu/rel:x'", 2, {"\"rel:x\""});
  expect_error("graze repro uniform:1:1 --lanes 'projected_sat/f32/cpu/bound'", 2,
               {"projected_sat is wrong on some pairs even without rounding"});
  expect_error("graze repro uniform:1:1 --lanes 'nothing/f32/cpu/rel:1'", 2, {"nothing/f32/cpu/rel:1"});
}

TEST_F(TuneCommand, AFreshCampaignConfirmsWhatItRecommends) {
  const std::string tune =
      "graze tune moller_1997/f32/cpu --strata 'near_*' --pairs 20k --forbid false-negative --max-rate 1e-3 "
      "--max-other 0.75 ";
  const Ran ran = shell.done(tune + "--out t");
  EXPECT_EQ(ran.out.find("Use "), 0u) << ran.out;
  const auto json = shell.json("t/tune.json");
  ASSERT_EQ(json["result"], "satisfied") << ran.out;
  const std::string policy = json["chosen"];
  // With ten times the pairs and another seed, the rate stays below the reported bound.
  expect_done("graze fuzz --strata 'near_*' --pairs 200k --seed 99 --lanes 'moller_1997/f32/cpu/" + policy +
              "' --out c > /dev/null");
  double negatives = 0;
  const auto summary = shell.json("c/summary.json");
  for (const auto& [stratum, row] : summary["strata"].items())
    negatives += row["lanes"]["moller_1997/f32/cpu/" + policy]["false_negative"].get<double>();
  EXPECT_LE(negatives / 200'000, json["bound"].get<double>());
  // The bytes are the same for any number of threads.
  expect_done(tune + "--threads 1 --out u > /dev/null && diff -r t u");
  // The policy fixes or breaks the smallest cases as their file names say.
  for (const auto& [file, zero_wrong] : {std::pair{"fixed", true}, {"broken", false}}) {
    const Ran check = shell(std::string("graze check t/") + file +
                            ".pairs --lanes 'moller_1997/f32/cpu,moller_1997/f32/cpu/" + policy + "' | grep moller");
    const std::string first = check.out.substr(0, check.out.find('\n')), second = check.out.substr(first.size() + 1);
    EXPECT_EQ(first.find(" !") != std::string::npos, zero_wrong) << check.out;
    EXPECT_EQ(second.find(" !") != std::string::npos, !zero_wrong) << check.out;
  }
}

// `--from` lists the campaign's own disagreements and shows what each tolerance in the table does to them.
TEST_F(TuneCommand, ChoosesOnTheDisagreementsOfACampaign) {
  expect_done("graze fuzz --strata 'near_*' --pairs 8k --seed 7 --lanes 'moller_1997/f32/*' --out c > /dev/null");
  const std::string tune = "graze tune moller_1997/f32/cpu --from c --forbid false-negative --max-rate 1e-2 ";
  const Ran ran = shell.done(tune + "--max-other 0.5 --pairs 6k --out t");
  const auto tuned = shell.json("t/tune.json"), campaign = shell.json("c/summary.json");
  EXPECT_EQ(tuned["zero"]["pairs"], 8000);
  EXPECT_EQ(tuned["confirmed"]["pairs"], 6000);
  std::uint64_t wrong = 0;
  for (const auto& [stratum, row] : campaign["strata"].items()) {
    for (const char* error : {"false_negative", "false_positive"})
      wrong += row["lanes"]["moller_1997/f32/cpu"][error].get<std::uint64_t>();
  }
  std::map<std::string, std::uint64_t> rows;
  std::map<std::string, std::string> last;
  std::ifstream csv(shell.folder / "t/changes.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "stratum,seed,index,truth,tolerance,change");
  while (std::getline(csv, line)) {
    const std::size_t change = line.rfind(','), tolerance = line.rfind(',', change - 1);
    ++rows[line.substr(tolerance + 1)];
    last[line.substr(tolerance + 1)] = line.substr(0, tolerance);
  }
  EXPECT_GT(wrong, 100u);
  EXPECT_EQ(rows["none,wrong"], wrong);
  int tolerances = 0;
  for (const auto& curve : tuned["curves"]) {
    for (const auto& point : curve["points"]) {
      const std::string policy = point["policy"];
      if (rows[policy + ",fixes"] + rows[policy + ",breaks"] == 0) continue;
      EXPECT_EQ(rows[policy + ",fixes"], point["fixed"]) << policy;
      EXPECT_EQ(rows[policy + ",breaks"], point["broken"]) << policy;
      EXPECT_TRUE(has(ran.out, {"\n" + policy + " "}));
      ++tolerances;
    }
  }
  EXPECT_GE(tolerances, 4);
  // For each kind of change, one pair is drawn again by its seed and index.
  const std::string chosen = tuned["chosen"];
  for (const auto& [key, zero_wrong, chosen_wrong] :
       {std::tuple{chosen + ",fixes", true, false}, {chosen + ",breaks", false, true}}) {
    ASSERT_TRUE(last.contains(key)) << key;
    std::string place = last[key].substr(0, last[key].rfind(','));
    std::replace(place.begin(), place.end(), ',', ':');
    const Ran again = shell("graze repro " + place + " --lanes 'moller_1997/f32/cpu,moller_1997/f32/cpu/" + chosen +
                            "' | grep moller_1997/f32");
    const std::size_t second = again.out.find('\n') + 1;
    EXPECT_EQ(again.out.substr(0, second).find(" !") != std::string::npos, zero_wrong) << place << '\n' << again.out;
    EXPECT_EQ(again.out.find(" !", second) != std::string::npos, chosen_wrong) << place << '\n' << again.out;
  }
  // Any number of threads gives the same bytes. A later run that does not write changes.csv removes it.
  expect_done(tune + "--max-other 0.5 --pairs 6k --threads 1 --out u > /dev/null && diff -r t u");
  expect_done("graze tune moller_1997/f32/cpu --strata near_vertex_face --pairs 1k --out t > /dev/null");
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "t/changes.csv"));
  expect_error("graze tune moller_1997/f64/cpu --from c", 2, {"c: it did not run moller_1997/f64/cpu"});
  expect_error(tune + "--scene x.toml", 2, {"--scene", "--from"});
}

// A campaign that ran different code: its counts are plausible, but a recount on its pairs gives other counts.
TEST_F(TuneCommand, ACampaignWhosePairsShowOtherErrorsIsRefused) {
  expect_done("graze fuzz --strata near_edge_edge --pairs 2k --lanes moller_1997/f32/cpu --out c > /dev/null");
  auto summary = shell.json("c/summary.json");
  auto& stratum = summary["strata"]["near_edge_edge"];
  const std::string lane = "moller_1997/f32/cpu";
  const auto less = [](nlohmann::ordered_json& count) { count = count.get<int>() - 1; };
  less(stratum["lanes"][lane]["false_negative"]);
  less(stratum["margins"]["-2^-1"]["wrong"].at(lane));
  less(summary["disagreements"]);
  less(std::find_if(summary["signatures"].begin(), summary["signatures"].end(), [](const auto& signature) {
         return signature["key"].template get<std::string>().find("moller_1997:-") != std::string::npos &&
                signature["count"] > 1;
       })->at("count"));
  std::filesystem::remove(shell.folder / "c/campaign.sqlite");
  std::ofstream(shell.folder / "c/summary.json") << summary.dump(1);
  expect_error("graze tune moller_1997/f32/cpu --from c", 1,
               {"wrong verdicts of moller_1997/f32/cpu in near_edge_edge", "other code", "record was changed"});
}

// If one file in the folder belongs to another program, no file is written.
TEST_F(TuneCommand, AForeignFileStopsItBeforeAnythingIsWritten) {
  const std::string tune = "graze tune moller_1997/f32/cpu --strata near_vertex_face --pairs 1k --out t";
  expect_done(tune + " > /dev/null && echo mine > t/policy.h && cp -r t before");
  expect_error(tune + " --seed 2 > /dev/null", 2, {"t/policy.h", "--force"});
  expect_done("diff -r t before && rm -r t/policy.h && mkfifo t/policy.h");
  expect_error("timeout 60 " + tune + " --seed 2 > /dev/null", 1, {"t/policy.h", "pipe"});
  expect_done("cmp t/tune.json before/tune.json");
}

TEST_F(TuneCommand, NextIsACommandThatRuns) {
  // The first run fixes and breaks pairs, and the second run in the same folder does not.
  for (const char* lane : {"moller_1997/f32/cpu --strata near_vertex_face --forbid false-negative --max-rate 1e-2",
                           "guigue_devillers_2003/f64/cpu --strata uniform --max-rate 1e-2"}) {
    const Ran ran = shell.done(std::string("graze tune --pairs 3k --out t ") + lane);
    const std::size_t at = ran.out.find("\nNext: ");
    ASSERT_NE(at, std::string::npos) << ran.out;
    expect_done(ran.out.substr(at + 7));
  }
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "t/fixed.pairs"));
}

// The header, compiled by itself, gives the same verdicts as the lane on fresh pairs.
TEST_F(TuneCommand, TheHeaderDecidesAsTheLane) {
  expect_done(
      "graze tune moller_1997/f32/cpu --strata near_vertex_face --pairs 5k --forbid false-negative --max-rate 1e-2 "
      "--out t > "
      "/dev/null");
  std::ofstream(shell.folder / "main.cpp") << R"(#include "t/policy.h"
#include <cstdio>
int main() {
  float x[18];
  while (true) {
    for (float& c : x) {
      if (std::scanf("%f", &c) != 1) return 0;
    }
    float a[9], b[9];
    for (int i = 0; i < 9; ++i) a[i] = x[i], b[i] = x[9 + i];
    std::puts(triangles_intersect(a, b) ? "intersects" : "disjoint");
  }
}
)";
  const std::string chosen = shell.json("t/tune.json")["chosen"];
  ASSERT_NE(chosen, "zero");
  expect_done("g++ -std=c++20 -O2 -Wall -Wextra -Werror -ffp-contract=off main.cpp -o main");
  expect_done(
      "graze dump near_vertex_face:5 --pairs 300 --format pairs | grep -v graze | cut -d'|' -f1 | ./main > by_header");
  expect_done("graze dump near_vertex_face:5 --pairs 300 --format csv --lanes 'moller_1997/f32/cpu/" + chosen +
              "' | tail -n 300 | sed 's/.*,//' > by_lane; cmp by_header by_lane && grep -q disjoint by_lane && grep -q "
              "intersects by_lane");
}

TEST_F(TuneCommand, BadInputGetsOneLine) {
  expect_error("graze tune", 2, {"LANE"});
  expect_error("graze tune moller_1997/f32/cp", 2, {"'moller_1997/f32/cpu'"});
  expect_error("graze tune exact/f32/cpu", 2, {"published", "'exact/f32/cpu'"});
  expect_error("graze tune moller_1997/f32/cpu --max-rate 0", 2, {"--max-rate"});
  expect_error("graze tune moller_1997/f32/cpu --strata nothing", 2, {"nothing"});
  expect_error("graze tune moller_1997/f32/cuda-fast", 2, {"twin"});
}

TEST_F(TuneCommand, HelpHasExamplesThatRun) {
  std::ofstream(shell.folder / "mine.cpp") << "constexpr float kEps = 1e-6f;\nbool intersects(const float a[9], const "
                                              "float b[9]) { return a[0] > b[0] + kEps; }\n";
  const Ran help = shell("graze tune --help");
  int examples = 0;
  for (std::size_t at = 0; (at = help.out.find("Example: ", at)) != std::string::npos; at += 9, ++examples) {
    const std::string example = help.out.substr(at + 9, help.out.find('\n', at) - at - 9);
    expect_done(example.find("--pairs") == std::string::npos ? example + " --pairs 20k" : example);
  }
  EXPECT_EQ(examples, 3);
}

// Counts the differing verdicts again from `graze dump`, independently of agree.json. `policy`: "" or "/POLICY".
std::size_t recounted(const Shell& shell, const std::string& strata, std::uint64_t seed, int pairs,
                      const std::string& first, const std::string& second, const std::string& policy) {
  const Ran ran = shell.done("graze dump " + strata + ":" + std::to_string(seed) + " --pairs " + std::to_string(pairs) +
                             " --format csv --lanes '" + first + policy + "," + second + policy + "' | tail -n " +
                             std::to_string(pairs) + " | awk -F, '$(NF-1) != $NF' | wc -l");
  return std::stoul(ran.out);
}

// A recount gives the same numbers, a fresh seed confirms the bounds, and the number of threads changes no byte.
TEST_F(AgreeCommand, FreshPairsConfirmItForTwoAlgorithms) {
  for (const auto& [subject, stratum, result] : {std::tuple{"guigue_devillers_2003/f64", "shared_vertex", "satisfied"},
                                                 {"interval_overlap/f32", "shared_vertex", "not satisfiable"}}) {
    const std::string cpu = subject + std::string("/cpu"), cuda = subject + std::string("/cuda-fma");
    const std::string tune =
        "graze tune " + cpu + " " + cuda + " --agree --strata " + stratum + " --pairs 10k --max-rate 3e-3 ";
    const Ran ran = shell.done(tune + "--out t");
    const auto json = shell.json("t/agree.json");
    ASSERT_EQ(json["result"], result) << ran.out;
    const std::string policy = json["chosen"] == "zero" ? "" : "/" + json["chosen"].get<std::string>();
    EXPECT_EQ(json["zero_confirmed"]["differing"], recounted(shell, stratum, 2, 10'000, cpu, cuda, "")) << ran.out;
    EXPECT_EQ(json["confirmed"]["differing"], recounted(shell, stratum, 2, 10'000, cpu, cuda, policy)) << ran.out;
    EXPECT_GT(json["zero_confirmed"]["differing"], 100) << ran.out;
    EXPECT_EQ(json["rounded"]["agreement"]["differing"], 0) << ran.out;
    EXPECT_TRUE(has(ran.out, {"(exact/f32/cpu and exact/f32/cuda)"}));
    // With twice the pairs and another seed, the rate stays within the bound.
    const double fresh = static_cast<double>(recounted(shell, stratum, 99, 20'000, cpu, cuda, policy)) / 20'000;
    if (result == std::string("satisfied")) {
      EXPECT_LE(fresh, json["high"].get<double>());
    } else {
      EXPECT_GE(fresh, json["low"].get<double>());
      EXPECT_GT(json["low"].get<double>(), 3e-3);
      EXPECT_EQ(ran.out.find("No tolerance that was tried keeps"), 0u) << ran.out;
    }
    expect_done(tune + "--threads 1 --out u > /dev/null && diff -r t u");
    expect_done(
        "xmllint --noout t/curves.svg 2> /dev/null || python3 -c 'import xml.dom.minidom as m; "
        "m.parse(\"t/curves.svg\")'");
    // On the smallest cases the lanes differ, without the policy and with it.
    EXPECT_EQ(shell("graze check t/differ.pairs --lanes '" + cpu + "," + cuda + "' | grep -c ' !'").out, "1\n");
    EXPECT_EQ(std::filesystem::exists(shell.folder / "t/differ_under.pairs"), json["confirmed"]["differing"] > 0);
    if (json["confirmed"]["differing"] > 0) {
      const std::string check = "graze check t/differ_under.pairs --lanes '" + cpu + policy + "," + cuda + policy + "'";
      EXPECT_EQ(shell(check + " | grep -c ' !'").out, "1\n");
    }
    const std::size_t next = ran.out.find("\nNext: ");
    ASSERT_NE(next, std::string::npos) << ran.out;
    expect_done(ran.out.substr(next + 7));
  }
}

TEST_F(AgreeCommand, SaysWhatNeedsNoPolicyAndWhatIsNotSettled) {
  const std::string tune = "graze tune moller_1997/f32/cpu moller_1997/f32/cuda-nofma --agree --strata 'near_*' ";
  const Ran settled = shell(tune + "--pairs 4k --max-rate 1e-3 --out t");
  EXPECT_EQ(settled.out.find("No policy is needed: "), 0u) << settled.out << settled.err;
  EXPECT_FALSE(has(settled.out, {"Without a tolerance: "}));  // there is nothing to fix
  EXPECT_EQ(shell.json("t/agree.json")["chosen"], "zero");
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "t/differ.pairs"));
  const Ran open = shell(tune + "--pairs 4k --max-rate 1e-4 --out t");
  EXPECT_EQ(open.out.find("Not settled: "), 0u) << open.out << open.err;
  EXPECT_TRUE(has(open.out, {"29,956"}));  // log(0.05) / log(1 - 1e-4)
  EXPECT_EQ(shell.json("t/agree.json")["result"], "too few pairs");
}

TEST_F(AgreeCommand, LeavesOutWhatTheTwinCannotReplay) {
  const Ran ran = shell.done(
      "graze tune interval_overlap/f32/cuda-fma interval_overlap/f32/cpu --agree --strata shared_edge --pairs 2k "
      "--out t");
  const auto json = shell.json("t/agree.json");
  EXPECT_EQ(json["without_relative"], "interval_overlap/f32/cuda-fma");
  EXPECT_EQ(json["curves"].size(), 4u);
  for (const auto& curve : json["curves"]) EXPECT_EQ(curve["tolerance"], "abs");
  EXPECT_TRUE(has(ran.out, {"Relative tolerances are left out: "}));
}

TEST_F(AgreeCommand, BadInputGetsOneLine) {
  const std::string cpu = "moller_1997/f32/cpu", fma = "moller_1997/f32/cuda-fma";
  expect_error("graze tune " + cpu + " --agree", 2, {"--agree", "two lanes"});
  expect_error("graze tune " + cpu + " " + fma, 2, {"--agree", "two lanes"});
  expect_error("graze tune " + cpu + " " + fma + " " + cpu + " --agree", 2, {"3 lanes"});
  expect_error("graze tune " + cpu + " moller_1997/f64/cpu --agree", 2, {cpu, "moller_1997/f64/cpu", "scalar"});
  expect_error("graze tune " + cpu + " interval_overlap/f32/cpu --agree", 2, {cpu, "interval_overlap/f32/cpu"});
  expect_error("graze tune " + cpu + " moller_1997/f32/cuda-fast --agree", 2, {"moller_1997/f32/cuda-fast", "twin"});
  expect_error("graze tune " + cpu + " " + fma + " --agree --forbid any", 2, {"--forbid", "--agree"});
  expect_error("graze tune " + cpu + " moller_1997/f32/cud --agree", 2, {"moller_1997/f32/cud"});
  expect_error("graze tune " + cpu + " " + fma + " --agree --max-rate 0", 2, {"--max-rate"});
}

TEST_F(ParetoCommand, SetsErrorsAgainstCosts) {
  expect_out(
      "graze pareto --strata 'near_*,extreme_scale' --pairs 3000 --lanes "
      "'*/f32/cpu,exact/f32/cpu,moller_1997/f32/cpu/paper' --out t",
      {"\n  Scaled by 2^k", "\nWith one pair per call"});
  const auto json = shell.json("t/pareto.json");
  ASSERT_EQ(json["lanes"].size(), 7u);
  double before = 0;
  for (const auto& row : json["lanes"]) {
    EXPECT_GE(row["in_cache"]["middle"], before);
    before = row["in_cache"]["middle"];
    EXPECT_GT(row["one_a_call"]["middle"], 0);
    EXPECT_EQ(row["errors"]["pairs"], 3000);
    if (row["lane"] == "exact/f32/cpu") {
      EXPECT_EQ(row["errors"]["false_negative"], 0);
      EXPECT_EQ(row["errors"]["false_positive"], 0);
      EXPECT_FALSE(row["dominated"].get<bool>());
    }
  }
  EXPECT_EQ(json["extremes"].size(), 4u * 7);
  for (const char* picture : {"front", "scale", "offset", "flatness", "aspect"})
    expect_done("xmllint --noout t/" + std::string(picture) +
                ".svg 2> /dev/null || python3 -c 'import xml.dom.minidom as m; m.parse(\"t/" + picture + ".svg\")'");
  // Errors do not depend on the machine; costs do.
  expect_done(
      "graze pareto --strata 'near_*,extreme_scale' --pairs 3000 --lanes "
      "'*/f32/cpu,exact/f32/cpu,moller_1997/f32/cpu/paper' --out u > /dev/null && "
      "cmp t/scale.svg u/scale.svg && cmp t/offset.svg u/offset.svg");
}

TEST_F(ParetoCommand, NamesTheLanesThatItLeavesOut) {
  const std::string pareto = "graze pareto --strata near_edge_edge --pairs 1000 ";
  const Ran ran = shell.done(pareto + "--lanes 'moller_1997/f32/c*fma,moller_1997/f32/cpu' --out t");
  EXPECT_TRUE(has(ran.err, {"graze: left out (only --device times CUDA lanes): moller_1997/f32/cuda-"}));
  const auto json = shell.json("t/pareto.json");
  EXPECT_EQ(json["lanes_left_out"]["why"]["moller_1997/f32/cuda-fma"], "only --device times CUDA lanes");
  expect_error(pareto + "--lanes 'moller_1997/f32/cpu,moller_1997/f32/cuda-fma' --out u", 2,
               {"'moller_1997/f32/cuda-fma'"});
}

TEST_F(ParetoCommand, DrawsWithinAScene) {
  std::ofstream(shell.folder / "hall.toml") << "extent = [[100, 108], [0, 4], [0, 4]]\nedges = [0.5, 1, 2]\n";
  expect_out("graze pareto --scene hall.toml --pairs 2000 --lanes 'moller_1997/f32/cpu,exact/f32/cpu' --out t",
             {"extreme_scale: your coordinates stay within 0 … 108"});
  expect_out("graze tune moller_1997/f64/cpu --scene hall.toml --pairs 2000 --out u",
             {"extreme_scale: your coordinates stay within 0 … 108"});
  expect_error("graze tune moller_1997/f64/cpu --scene nowhere.toml", 1, {"nowhere.toml"});
}

}  // namespace
}  // namespace graze::cli
