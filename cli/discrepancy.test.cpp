// SPDX-License-Identifier: Apache-2.0
// `graze discrepancy`, `graze dump --values` and `graze explain` with two lanes, as users run them.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/run_graze.h"
#include "fuzz/sealed.h"
#include "strata/pair_source.h"

namespace graze::cli {
namespace {

class DiscrepancyCommand : public CommandTest {};

TEST_F(DiscrepancyCommand, LeavesTheSameBytesWhateverTheThreads) {
  const std::string run =
      "graze discrepancy interval_overlap/f32/cpu interval_overlap/f32/cuda-fma --executor twin "
      "--strata 'near_*,thesis' --pairs 3000 ";
  const Ran first = shell(run + "--threads 1 --out one"), second = shell(run + "--threads 3 --out three");
  ASSERT_EQ(first.status, 0) << first.err;
  ASSERT_EQ(second.status, 0) << second.err;
  expect_done("diff -r one three");
  const auto lanes = shell.json("one/discrepancy.json")["lanes"][0];
  EXPECT_EQ(lanes["total"]["pairs"], 3000);
  std::uint64_t differs = 0;
  for (const auto& [stratum, of] : lanes["strata"].items()) differs += of["differs"].get<std::uint64_t>();
  EXPECT_EQ(lanes["total"]["differs"], differs);
  EXPECT_GT(differs, 1000u);
  EXPECT_GT(lanes["origins"]["lines"].size(), 5u);
}

// An independent program counts the values again in rational arithmetic.
TEST_F(DiscrepancyCommand, CountsAreThoseOfAProgramThatSharesNoCode) {
  struct Case {
    const char *first, *second, *stratum;
  };
  for (const auto& [first, second, stratum] :
       {Case{"interval_overlap/f32/cpu", "interval_overlap/f32/cuda-fma", "thesis"},
        Case{"moller_1997/f64/cpu", "moller_1997/f64/cuda-fma", "coplanar_wide"},
        Case{"separating_axes/f32/cpu", "separating_axes/f32/cpu-fma", "near_edge_edge"},
        Case{"guigue_devillers_2003/f32/cuda-fma", "guigue_devillers_2003/f32/cpu", "extreme_scale"},
        Case{"projected_sat/f64/cpu", "projected_sat/f64/cuda-fma", "lattice"},
        Case{"interval_overlap/f64/cpu", "interval_overlap/f64/cuda-fma", "near_edge_edge/f64"},
        Case{"moller_1997/f64/cuda-fma", "moller_1997/f64/cuda-nofma", "stored/f64"},
        Case{"guigue_devillers_2003/f64/cpu", "guigue_devillers_2003/f64/cuda-fma", "extreme_scale/f64"},
        Case{"separating_axes/f64/cpu", "separating_axes/f64/cpu-fma", "large_offset/f64"},
        Case{"projected_sat/f64/cpu", "projected_sat/f64/cuda-fma", "construction_born/f64"}}) {
    const std::string lanes = std::string(first) + " " + second;
    const std::string pairs =
        std::string(stratum).ends_with("/f64") ? " --coordinates f64 --pairs 200 " : " --pairs 200 ";
    expect_done("graze discrepancy " + lanes + " --executor twin --strata " + stratum + pairs + "--seed 5 --out d");
    expect_out("graze dump " + std::string(stratum) + ":5 --pairs 200 --values " + first + "," + second +
                   " | python3 -B " GRAZE_SOURCE_DIR "/scripts/recount_discrepancy d/discrepancy.json " + stratum,
               {"200 pairs, ", " 0 differ"});
  }
}

// The verb finds as many differing verdicts as a campaign on the same pairs. The campaign's report links to the page.
TEST_F(DiscrepancyCommand, ACampaignsColumnIsTheSumOfItsVerdicts) {
  const std::string first = "interval_overlap/f32/cpu", second = "interval_overlap/f32/cuda-fma";
  expect_done("graze fuzz --lanes " + first + "," + second +
              " --executor twin --strata 'thesis,near_edge_edge,coplanar_*' --pairs 5003 --out c");
  expect_done("graze discrepancy " + first + " " + second + " --executor twin --campaign c --pairs 5003");
  const auto summary = shell.json("c/summary.json"), found = shell.json("c/discrepancy.json");
  EXPECT_EQ(found["pairs"], 5003);
  std::uint64_t verdicts = 0;
  for (const auto& [stratum, of] : found["lanes"][0]["strata"].items()) {
    EXPECT_EQ(of["pairs"], summary["strata"][stratum]["pairs"]) << stratum;
    EXPECT_EQ(of["verdict"], summary["strata"][stratum]["lanes"][second]["differs_from_cpu"]) << stratum;
    verdicts += of["verdict"].get<std::uint64_t>();
  }
  EXPECT_GT(verdicts, 50u);
  expect_done("graze report c");
  EXPECT_TRUE(has(shell.file("c/report.html"), {"discrepancy.html"}));
  const std::string other_pairs = "that the campaign did not draw (seed 7)",
                    compare = "graze discrepancy " + first + " " + second + " --executor twin --pairs 50 ";
  EXPECT_FALSE(has(shell.file("c/report.html"), {other_pairs}));
  EXPECT_FALSE(has(shell(compare + "--campaign c --out elsewhere").out, {"Next: "}));
  expect_done(compare + "--strata lattice --seed 7 --out c");
  expect_done("graze report c");
  EXPECT_TRUE(has(shell.file("c/report.html"), {other_pairs}));
  // This command draws more pairs of a stratum than the campaign did.
  expect_done("graze discrepancy " + first + " " + second + " --executor twin --pairs 2000 --strata thesis --out c");
  expect_done("graze report c");
  EXPECT_TRUE(has(shell.file("c/report.html"), {"that the campaign did not draw (seed 1)"}));
  // An edited count is refused.
  auto forged = found;
  forged["lanes"][0]["strata"]["thesis"]["verdict"] = 5004;
  std::ofstream(shell.folder / "c/discrepancy.json") << forged.dump();
  EXPECT_EQ(shell("graze report c").status, 1);
}

// A comparison on a campaign's pairs uses the campaign's scene.
TEST_F(DiscrepancyCommand, ACampaignsPairsAreThoseOfItsScene) {
  std::ofstream(shell.folder / "hall.toml") << "extent = [[100, 108], [0, 4], [0, 4]]\nedges = [0.5, 1, 2]\n";
  const std::string lanes = "moller_1997/f32/cpu,moller_1997/f32/cuda-fma", scene = " --scene hall.toml --pairs 600 ";
  expect_done("graze fuzz --lanes " + lanes + " --executor twin" + scene + "--out c");
  const std::string compare = "graze discrepancy moller_1997/f32/cpu moller_1997/f32/cuda-fma --executor twin ";
  expect_done(compare + "--campaign c");
  expect_done(compare + scene + "--out d");
  expect_done("cmp c/discrepancy.json d/discrepancy.json");
  const auto found = shell.json("c/discrepancy.json");
  EXPECT_TRUE(found["scene"].get<std::string>().starts_with("hall.toml#")) << found["scene"];
  EXPECT_EQ(found["pairs"], 600);
  EXPECT_TRUE(has(shell.file("c/discrepancy.html"), {"scene hall.toml"}));
  expect_done(compare + "--pairs 600 --out e");
  expect_error("graze discrepancy --compare c e", 2, {"scene"});
  expect_done(compare + "--pairs 600 --strata lattice --out f");
  expect_error("graze discrepancy --compare e f", 2, {"strata"});
  expect_error("graze discrepancy moller_1997/f32/cpu moller_1997/f32/cpu-fast", 2, {"cpu-fast", "fast math"});
  const std::string other_pairs = "that the campaign did not draw";
  expect_done("graze report c");
  EXPECT_FALSE(has(shell.file("c/report.html"), {other_pairs}));
  expect_done("cp e/discrepancy.json c && graze report c");
  EXPECT_TRUE(has(shell.file("c/report.html"), {other_pairs}));
}

// For a user's code, only verdicts are compared, and the output says why values are not.
TEST_F(DiscrepancyCommand, ComparesTheVerdictsOfYourOwnCode) {
  std::ofstream(shell.folder / "mine.cpp") << R"(
static float side(const float* t, const float* p) {
  const float u[] = {t[3] - t[0], t[4] - t[1], t[5] - t[2]}, v[] = {t[6] - t[0], t[7] - t[1], t[8] - t[2]};
  const float n[] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return n[0] * (p[0] - t[0]) + n[1] * (p[1] - t[1]) + n[2] * (p[2] - t[2]);
}
static bool crosses(const float* t, const float* p) {
  const float x = side(t, p), y = side(t, p + 3), z = side(t, p + 6);
  return !(x > 0 && y > 0 && z > 0) && !(x < 0 && y < 0 && z < 0);
}
bool meet(const float a[9], const float b[9]) { return crosses(a, b) && crosses(b, a); }
)";
  const std::string first = "mine/f32/cpu", second = "mine/f32/cpu-fma";
  const Ran ran =
      shell.done("graze discrepancy " + first + " " + second +
                 " --subject mine=./mine.cpp:meet --executor twin --strata shared_vertex --pairs 1000 --out m");
  std::string words = ran.out;
  std::replace(words.begin(), words.end(), '\n', ' ');
  EXPECT_TRUE(has(words, {"Only verdicts are compared"})) << ran.out;
  const auto found = shell.json("m/discrepancy.json");
  EXPECT_EQ(found["lanes"].size(), 0u);
  const auto& of = found["verdicts"][0]["strata"]["shared_vertex"];
  expect_done("graze fuzz --subject mine=./mine.cpp:meet --lanes " + first + "," + second +
              " --executor twin --strata shared_vertex --pairs 1000 --out c");
  const auto counted = shell.json("c/summary.json")["strata"]["shared_vertex"];
  EXPECT_EQ(of["pairs"], counted["pairs"]);
  EXPECT_EQ(of["differs"], counted["lanes"][second]["differs_from_cpu"]);
  EXPECT_GT(of["differs"], 50);
  for (const char* error : {"false_positive", "false_negative"}) {
    EXPECT_EQ(of["of_first"][error], counted["lanes"][first].value(error, 0)) << error;
    EXPECT_EQ(of["of_second"][error], counted["lanes"][second].value(error, 0)) << error;
  }
  const Ran same = shell("graze discrepancy --compare m m");
  EXPECT_TRUE(has(same.out, {"0 numbers differ, "})) << same.err;
  EXPECT_FALSE(has(same.out, {", 0 are the same"}));
  // A comparison with the results of different code says that the code differs.
  expect_done("sed -i 's/x > 0/x >= 0/' mine.cpp");
  expect_done("graze discrepancy " + first + " " + second +
              " --subject mine=./mine.cpp:meet --executor twin --strata shared_vertex --pairs 1000 --out edited");
  EXPECT_TRUE(has(shell("graze discrepancy --compare m edited").out, {"The code of mine differs:"}));
  expect_done("sed -i 's/x >= 0/x > 0/' mine.cpp");
  // The simplest pair shows the difference. The campaign's report, too, says that only verdicts are compared.
  const Ran pair = shell("graze repro " + of["simplest"]["place"].get<std::string>() +
                         " --subject mine=./mine.cpp:meet --lanes 'mine/f32/cpu,mine/f32/cpu-fma' | grep '^  mine'");
  EXPECT_NE(pair.out.find('!'), std::string::npos) << pair.out << pair.err;
  expect_done("graze discrepancy " + first + " " + second + " --campaign c --pairs 1000");
  expect_done("graze report c");
  EXPECT_TRUE(has(shell.file("c/report.html"), {"Only verdicts are compared"}));
  auto forged = shell.json("c/discrepancy.json");
  forged["verdicts"][0]["strata"]["shared_vertex"]["differs"] = 1001;
  std::ofstream(shell.folder / "c/discrepancy.json") << forged.dump();
  EXPECT_EQ(shell("graze report c").status, 1);
}

// The example in subjects/examples agrees with interval_overlap unless the x87 keeps extra bits in its registers.
TEST_F(DiscrepancyCommand, TheThesissAlgorithmDiffersOnTheX87) {
#ifndef __x86_64__
  GTEST_SKIP() << "this processor has no x87";
#endif
  const auto differs = [&](const std::string& flags, const std::string& with) -> std::uint64_t {
    expect_done("graze discrepancy x87/f32/cpu interval_overlap/f32/" + with +
                " --executor twin --strata thesis --pairs 20k --out x --subject x87=" GRAZE_SOURCE_DIR
                "/subjects/examples/interval_overlap.cpp --flags='-I" GRAZE_SOURCE_DIR +
                flags + "'");
    return shell.json("x/discrepancy.json")["verdicts"][0]["total"]["differs"];
  };
  EXPECT_EQ(differs("", "cpu"), 0u);
  EXPECT_EQ(differs(" -mfpmath=387 -ffloat-store", "cpu"), 0u);
  const std::uint64_t fused = differs("", "cuda-fma"), x87 = differs(" -mfpmath=387", "cuda-fma");
  EXPECT_GT(fused, 0u);
  EXPECT_GT(x87, fused);
}

// For a CUDA source, operands of comparisons are compared too. In this source, only one of the two comparisons has
// products in its operands.
TEST_F(DiscrepancyCommand, ComparesTheOperandsOfYourOwnCudaSource) {
  std::ofstream(shell.folder / "mine.cu") << R"(
__device__ bool meet(const float a[9], const float b[9]) {
  const float x = a[0] + 0.1f, y = b[1] + 0.3f;
  if (x * (2 * y) - (2 * x) * y < 0)
    return true;
  return b[3] < a[3];
}
)";
  const Ran ran = shell(
      "graze discrepancy mine/f32/cuda-nofma mine/f32/cuda-fma --subject mine=./mine.cu:meet --executor twin --strata "
      "uniform,lattice --pairs 4000 --seed 5 --out m");
  if (ran.err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  ASSERT_EQ(ran.status, 0) << ran.err;
  std::uint64_t differs = 0, outcome = 0, verdict = 0, second = 0;
  for (const strata::PairSource& source : strata::stratum_sources(5, 4000, {"uniform", "lattice"})) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) {
      const Pair pair = source.pair(i);
      const float *a = coordinates(pair), *b = a + 9;
      const float x = a[0] + 0.1f, y = b[1] + 0.3f, product = 2 * x * y;
      const float rounded = x * (2 * y) - product, fused = std::fma(x, 2 * y, -product);
      differs += std::bit_cast<std::uint32_t>(rounded) != std::bit_cast<std::uint32_t>(fused);
      outcome += (rounded < 0) != (fused < 0);
      verdict += (rounded < 0 || b[3] < a[3]) != (fused < 0 || b[3] < a[3]);
      second += !(rounded < 0) && !(fused < 0);
    }
  }
  const auto found = shell.json("m/discrepancy.json")["verdicts"][0];
  const auto &operands = found["operands"], &lines = operands["lines"];
  EXPECT_EQ(operands["pairs"], 4000);
  EXPECT_EQ(operands["verdict"], verdict);
  EXPECT_EQ(found["total"]["differs"], verdict);
  ASSERT_EQ(lines.size(), 2u) << lines;
  EXPECT_EQ(lines[0]["compared"], 4000);
  EXPECT_EQ(lines[0]["differs"], differs);
  EXPECT_EQ(lines[0]["outcome"], outcome);
  EXPECT_EQ(lines[0]["verdict"], verdict);
  EXPECT_GE(lines[1]["compared"], second);  // even if the compiler merges both comparisons
  EXPECT_EQ(lines[1]["differs"], 0);
  EXPECT_TRUE(lines[0]["line"].get<std::string>().ends_with("mine.cu:4")) << lines;
  EXPECT_GT(verdict, 100u);
  EXPECT_GT(verdict, 5u);
  EXPECT_TRUE(has(ran.out, {"mine.cu:4"}));
  EXPECT_TRUE(has(shell.file("m/discrepancy.html"), {"mine.cu:4"}));
  EXPECT_TRUE(has(shell.file("m/discrepancy.csv"), {"mine.cu:4"}));

  // Impossible counts are refused even if the checksum is correct.
  for (const char* count : {"differs", "outcome", "verdict", "zero_sign"}) {
    auto forged = shell.json("m/discrepancy.json");
    forged.erase("checksum");
    auto& line = forged["verdicts"][0]["operands"]["lines"][0];
    line[count] = line["compared"].get<int>() + 1;
    std::filesystem::create_directories(shell.folder / "forged");
    std::ofstream(shell.folder / "forged/discrepancy.json") << fuzz::sealed(forged).dump();
    expect_error("graze discrepancy --compare m forged", 1, {"forged/discrepancy.json", "mine.cu:4"});
  }
}

// If code does not return when nothing is fused, its operands are not counted, but its verdicts are still compared.
TEST_F(DiscrepancyCommand, CodeThatHangsWithoutContractionLosesOnlyItsOperands) {
  std::ofstream(shell.folder / "slow.cu") << R"(
__device__ bool meet(const float a[9], const float b[9]) {
  const float t = a[1] * b[0];
  const float fused_if_contracted = a[0] * b[1] - t;
  const float fused = __fmaf_rn(a[0], b[1], -t);
  unsigned n = 1;
  if (fused_if_contracted != fused)
    for (unsigned i = 0; i != 4000000000u; ++i) n = n * n + i;
  return n != 0;
}
)";
  const Ran ran = shell(
      "graze discrepancy slow/f32/cuda-nofma slow/f32/cuda-fma --subject slow=./slow.cu:meet --subject-timeout 0.2 "
      "--executor twin --strata uniform --pairs 8 --out s");
  if (ran.err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto found = shell.json("s/discrepancy.json")["verdicts"][0];
  EXPECT_EQ(found["total"]["pairs"], 8);
  EXPECT_TRUE(found.contains("why_no_operands")) << found;
  EXPECT_TRUE(has(ran.out, {"does not return"}));
}

TEST_F(DiscrepancyCommand, PublishesEveryPart) {
  expect_done(GRAZE_SOURCE_DIR
              "/scripts/publish_discrepancy --pairs 400 --executor twin --out pub --graze "
              "$(command -v graze)");
  for (const char* part : {"thesis", "strata", "strata_nofma"}) {
    const std::string name = std::string("pub/") + part;
    const auto found = nlohmann::json::parse(shell("gzip -dc " + name + ".json.gz").out);
    EXPECT_EQ(found["lanes"].size(), 10u) << part;
    EXPECT_EQ(found["pairs"], 400) << part;
    std::uint64_t differs = 0;
    for (const auto& lanes : found["lanes"]) differs += lanes["total"]["differs"].get<std::uint64_t>();
    EXPECT_EQ(differs == 0, std::string(part) == "strata_nofma") << part << ": " << differs;
    EXPECT_TRUE(has(shell.file(name + ".html"), {"400 pairs"})) << part;
  }
  EXPECT_EQ(shell(GRAZE_SOURCE_DIR "/scripts/publish_discrepancy --graze nosuch").status, 2);
}

TEST_F(DiscrepancyCommand, ExplainShowsTwoLanesSideBySide) {
  expect_out("graze explain thesis:2012:1 --lanes interval_overlap/f32/cpu,interval_overlap/f32/cuda-fma",
             {"values differ, no comparison does", "plane_distance.b[0]"});
}

// By default a campaign's own code is compared. If only one lane of the campaign's code runs, published lanes are
// compared.
TEST_F(DiscrepancyCommand, ComparesTheCodeOfACampaign) {
  expect_done(
      "echo 'int intersects(const float* a, const float* b) { return a[0] * b[1] > a[1] * b[0]; }' > own.c; "
      "printf 'import sys\nfor line in sys.stdin: print(1, flush=True)\n' > own.py; "
      "graze fuzz --subject own=./own.c --lanes 'own/*' --strata uniform --pairs 40 --out c; "
      "graze fuzz --subject 'py=cmd:python3 own.py' --lanes 'py/*' --strata uniform --pairs 40 --out p");
  const std::string compare = "graze discrepancy --executor twin --pairs 40 --campaign ";
  for (const char* more : {"", " --subject own=./own.c"}) {
    const Ran own = shell.done(compare + "c --out d" + more);
    const auto found = shell.json("d/discrepancy.json");
    EXPECT_EQ(found["verdicts"].size(), 2u) << own.out;  // cpu-fma and cpu-fast, each with cpu
    EXPECT_TRUE(found["lanes"].empty());
  }
  expect_out(compare + "p", {"moller_1997/f32/cpu"});
}

TEST_F(DiscrepancyCommand, AVerdictThatAConventionAllowsIsNotCalledWrong) {
  for (const int answer : {0, 1})
    std::ofstream(shell.folder / (std::to_string(answer) + ".py"))
        << "import sys\nfor line in sys.stdin: print('{\"outside\": [\"touching\", \"shared\"]}' if line == "
           "'describe\\n' else "
        << answer << ", flush=True)\n";
  expect_out(
      "graze discrepancy none/f32/cpu all/f32/cpu --subject 'none=cmd:python3 0.py' --subject 'all=cmd:python3 1.py' "
      "--strata shared_vertex --pairs 40 --out d",
      {"alone is wrong on 0 pairs, all/f32/cpu alone on 0"});
}

TEST_F(DiscrepancyCommand, ComparesTwoResults) {
  const std::string run = "graze discrepancy --executor twin --strata thesis --pairs 2000 moller_1997/f32/cpu ";
  expect_done(run + "moller_1997/f32/cuda-fma --out a");
  expect_done(run + "moller_1997/f32/cuda-fma --out b");
  expect_done(run + "moller_1997/f32/cpu-fma --out c");
  const Ran same = shell("graze discrepancy --compare a b"), other = shell("graze discrepancy --compare a c");
  EXPECT_TRUE(has(same.out, {"0 numbers differ, "})) << same.err;
  EXPECT_TRUE(has(other.out, {"Only the first has moller_1997/f32/cpu against moller_1997/f32/cuda-fma."}))
      << other.err;
}

TEST_F(DiscrepancyCommand, RefusesWhatItCannotCompare) {
  for (const char* wrong :
       {"graze discrepancy moller_1997/f32/cpu", "graze discrepancy moller_1997/f32/cpu nosuch/f32/cpu",
        "graze discrepancy moller_1997/f32/cpu moller_1997/f64/cpu", "graze discrepancy exact/f32/cpu exact/f32/cuda",
        "graze discrepancy moller_1997/f32/cpu moller_1997/f32/cuda-fma moller_1997/f32/cuda-fma moller_1997/f32/cpu",
        "graze dump thesis --values moller_1997/f32/cpu", "graze discrepancy --compare a b --pairs 5",
        "graze discrepancy --campaign c --seed 3", "graze dump thesis --values exact/f32/cpu,exact/f32/cuda"}) {
    const Ran ran = shell(wrong);
    EXPECT_EQ(ran.status, 2) << wrong << ran.out;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
}

}  // namespace
}  // namespace graze::cli
