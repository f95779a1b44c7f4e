// SPDX-License-Identifier: Apache-2.0
// Pairs of doubles as users meet them: drawn, run, written, read and run again. Verbs that take only float32 pairs
// refuse pairs of doubles, and name them.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <sstream>

#include "cli/run_graze.h"
#include "corpus/pair_format.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

class Doubles : public CommandTest {
 protected:
  // A scene in metres on a millimetre grid, where neighbouring floats are half a metre apart.
  void write_survey() const {
    std::ofstream(shell.folder / "survey.toml")
        << "coordinates = \"f64\"\nunits = \"m\"\nextent = [[500000, 500300], [5400000, 5400300], [0, 60]]\n"
           "edges = [0.02, 30]\naspect = [1.2, 4, 3000]\ngrid = { decimals = 3 }\n";
  }

  // text: the contents of a file of pairs.
  static void expect_within_survey(const std::string& text) {
    std::istringstream in(text);
    int pairs = 0;
    for (corpus::PairReader reader(in, "text", PairTypes::both);;) {
      const std::optional<corpus::Entry> entry = reader.next();
      if (!entry) break;
      ASSERT_TRUE(entry->doubles.has_value());
      ++pairs;
      for (int k = 0; k < kCoordinates; ++k) {
        constexpr double kLow[] = {500000, 5400000, 0}, kHigh[] = {500300, 5400300, 60};
        const double x = coordinates(*entry->doubles)[k];
        EXPECT_TRUE(kLow[k % 3] <= x && x <= kHigh[k % 3]) << text;
        EXPECT_EQ(std::nearbyint(x * 1000) / 1000, x) << text;
      }
    }
    EXPECT_GT(pairs, 0);
  }
};

constexpr const char* kCampaign =
    "graze fuzz --coordinates f64 --strata 'stored,near_vertex_face' --pairs 600 --lanes '*/cpu' --out c > printed";

TEST_F(Doubles, ACampaignIsRepeatedByItsFiles) {
  expect_done(kCampaign);
  const std::string printed = shell.file("printed");
  EXPECT_TRUE(has(printed, {"graze repro c/cases/", "Next: graze minimize c"}));
  const Json summary = shell.json("c/summary.json");
  ASSERT_TRUE(summary["strata"].contains("stored/f64"));
  const Json& lanes = summary["strata"]["stored/f64"]["lanes"];
  EXPECT_GT(lanes["exact/f32/cpu"]["stored"], 290);  // of 300, as the stratum promises
  EXPECT_EQ(lanes["exact/f64/cpu"]["false_negative"], 0);
  const std::string file = summary["signatures"][0]["case"];
  expect_out("graze repro c/" + file + " --lanes '*/cpu'", {"(as recorded)"});
  const Ran report = shell.done("graze report c");
  EXPECT_TRUE(has(report.out, {"Next: graze minimize c"}));
  EXPECT_TRUE(has(shell.file("c/report.html"), {"stored/f64"}));
  const Json told = shell.json("c/report.json");
  int of_float = 0;
  for (const Json& row : told["rates"]) {
    const std::string lane = told["lanes"][row["lane"].get<std::size_t>()]["id"];
    EXPECT_EQ(row.contains("stored"), lane.find("/f32/") != std::string::npos) << row;
    if (!row.contains("stored") || row["stratum"].is_null()) continue;
    const std::string stratum = told["strata"][row["stratum"].get<std::size_t>()]["id"];
    EXPECT_EQ(row["stored"], summary["strata"][stratum]["lanes"][lane]["stored"]) << row;
    ++of_float;
  }
  EXPECT_GT(of_float, 8);
  EXPECT_TRUE(has(shell.file("c/rates.csv"), {"exact/f32/cpu,general,stored/f64,stored,"}));
  expect_done("graze fuzz --coordinates f64 --strata 'stored,near_vertex_face' --pairs 600 --lanes '*/cpu' --out c");
  expect_done(
      "graze fuzz --coordinates f64 --strata stored --pairs 100 --lanes 'moller_1997/*/cpu' --out j "
      "--junit j.xml");
  const std::string junit = shell.file("j.xml");
  EXPECT_TRUE(has(junit, {"name=\"stored/f64\"", "graze repro j/cases/"}));
  const Ran failed = shell(
      "graze fuzz --coordinates f64 --strata stored --pairs 100 --lanes 'moller_1997/*/cpu' --out k --fail-above 3");
  EXPECT_EQ(failed.status, 1);
  EXPECT_TRUE(has(failed.err, {"coordinates=f64"}));
}

// The exact lane in float decides what float32 stores, so its wrong verdicts are failures like those of other lanes.
TEST_F(Doubles, WhatStoringAloneGetsWrongIsAFailure) {
  const std::string fuzz =
      "graze fuzz --coordinates f64 --strata stored,large_offset --pairs 400 --lanes 'exact/*/cpu' --out s";
  expect_done(fuzz);
  const Json summary = shell.json("s/summary.json");
  std::uint64_t wrong = 0, of_signatures = 0;
  for (const Json& stratum : summary["strata"]) {
    const Json& lane = stratum["lanes"]["exact/f32/cpu"];
    wrong += lane["false_positive"].get<std::uint64_t>() + lane["false_negative"].get<std::uint64_t>();
  }
  EXPECT_GT(wrong, 200u);
  EXPECT_EQ(summary["disagreements"], wrong);
  for (const Json& row : summary["signatures"]) {
    EXPECT_TRUE(has(row["key"].get<std::string>(), {"/exact:"})) << row;
    of_signatures += row["count"].get<std::uint64_t>();
  }
  EXPECT_EQ(of_signatures, wrong);
  expect_done("graze minimize s");
  const std::string failures = shell("graze failures s").out;
  EXPECT_TRUE(has(failures, {"stored"}));
  const std::string file = "s/" + std::string(summary["signatures"][0]["case"]);
  const Ran explained = shell("graze explain " + file);
  EXPECT_TRUE(has(explained.out, {"float32"})) << explained.err;
  EXPECT_TRUE(has(shell("graze repro " + file).out, {"(as recorded)"}));
  expect_done("graze map " + file + " --lanes 'exact/*/cpu' --out map");
  expect_done("graze report s");
  const Ran failed = shell("rm -rf t; " + fuzz + " --fail-above 0 --out t");
  EXPECT_EQ(failed.status, 1);
  EXPECT_TRUE(has(failed.err, {"exact is wrong on "}));
}

TEST_F(Doubles, ATableIsReadBackWithTheSameTruth) {
  expect_done("graze dump stored/f64:7 --pairs 40 --format pairs --lanes 'exact/*/cpu,moller_1997/f32/cpu' > p.pairs");
  const Ran check = shell.done("graze check p.pairs --json --lanes 'exact/*/cpu,moller_1997/f32/cpu'");
  std::istringstream lines(check.out);
  int pairs = 0, changed = 0;
  for (std::string line; std::getline(lines, line); ++pairs) {
    const Json row = Json::parse(line);
    EXPECT_EQ(row["coordinates"], "f64");
    EXPECT_EQ(row["lanes"]["exact/f64/cpu"], row["truth"]["verdict"]);
    const bool differs = row["lanes"]["exact/f32/cpu"] != row["truth"]["verdict"];
    changed += differs;
    EXPECT_EQ(row.value("note", "").find("as stored in float32: ") != std::string::npos, differs) << line;
  }
  EXPECT_EQ(pairs, 40);
  EXPECT_GT(changed, 35);
  // The case names and a table of decimals give the same pairs.
  const std::string first = shell.file("p.pairs").substr(0, 400);
  expect_out("graze repro stored/f64:7:0 --lanes 'exact/*/cpu'", {"stored/f64:7:0"});
  expect_done("graze dump stored/f64:7 --pairs 40 > p.csv");
  expect_done(
      "python3 -c \"\nimport csv\nfor row in csv.DictReader(open('p.csv')):\n"
      " print(*[float(row[t + str(v) + c]).hex() for t in 'ab' for v in range(3) for c in 'xyz'])\n\" > decimals");
  std::istringstream written(shell.file("p.pairs")), decimals(shell.file("decimals"));
  std::string line;
  std::getline(written, line);  // the version
  for (std::string decimal; std::getline(decimals, decimal);) {
    ASSERT_TRUE(std::getline(written, line));
    std::istringstream l(line), r(decimal);
    std::string left, right;
    for (int i = 0; i < 18; ++i) {
      ASSERT_TRUE(l >> left && r >> right);
      EXPECT_EQ(std::stod(left), std::stod(right));
    }
  }
}

// Walls of a model in metres, far from the origin, in pairs that are one centimetre apart.
std::string walls(int count) {
  std::string text = fmt::format("OFF\n{} {} 0\n", 3 * count, count), faces;
  for (int i = 0; i < count; ++i) {
    const double x = 1000000 + 3 * (i / 2) + 0.01 * (1 + i % 2);
    text += fmt::format("{0:.2f} 0 0\n{0:.2f} 1 0\n{0:.2f} 0 1\n", x);
    faces += fmt::format("3 {} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2);
  }
  return text + faces;
}

TEST_F(Doubles, AMeshIsDrawnInItsDoubles) {
  std::ofstream(shell.folder / "walls.off") << walls(40);
  const std::string lanes = " --lanes 'exact/*/cpu,moller_1997/*/cpu' ";
  const Ran ran = shell.done("graze fuzz --mesh walls.off --coordinates f64" + lanes + "--out c");
  EXPECT_TRUE(has(ran.err, {"walls.off: decided in doubles, because 120 of 360 coordinates have more digits"}));
  const Json summary = shell.json("c/summary.json");
  const Json& mesh = summary["strata"]["mesh/f64"];
  EXPECT_EQ(mesh["pairs"], 20);  // float32 puts both walls into one plane
  EXPECT_EQ(mesh["intersects"], 0);
  EXPECT_EQ(mesh["lanes"]["exact/f64/cpu"]["false_positive"], 0);
  EXPECT_EQ(mesh["lanes"]["exact/f32/cpu"]["false_positive"], 20);
  EXPECT_EQ(mesh["lanes"]["exact/f32/cpu"]["stored"], 20);
  // The summary's command draws the same pairs again, and so do shards.
  const std::string bytes = shell.file("c/summary.json");
  expect_done("graze fuzz --mesh walls.off --coordinates f64" + lanes + "--out c > again && graze report c > told");
  EXPECT_EQ(shell.file("c/summary.json"), bytes);
  EXPECT_TRUE(has(shell.file("c/report.html"), {"--coordinates f64"}));
  expect_done(
      "graze dump c --format pairs > c.pairs && graze check c.pairs --lanes exact/f64/cpu | grep -q 'truth: disjoint'");
  const std::string file = "c/" + summary["signatures"][0]["case"].get<std::string>();
  expect_done("graze repro " + file + lanes);
  for (const char* k : {"1", "2"})
    expect_done(
        fmt::format("graze fuzz --mesh walls.off --coordinates both --strata uniform --pairs 60{}--shard {}/2 "
                    "--out s-{}",
                    lanes, k, k));
  expect_done(
      "graze merge s-1 s-2 --out both && graze fuzz --mesh walls.off --coordinates both --strata uniform "
      "--pairs 60" +
      lanes + "--out whole");
  Json both = shell.json("both/summary.json");
  EXPECT_EQ(both["strata"], shell.json("whole/summary.json")["strata"]);
  for (const char* source : {"uniform", "uniform/f64", "mesh", "mesh/f64"})
    EXPECT_TRUE(both["strata"].contains(source)) << source;
  EXPECT_EQ(both["strata"]["mesh"]["intersects"], 20);
  // `graze scene` reports what storing in float32 changes.
  const Ran scene = shell.done("graze scene walls.off --out walls.toml");
  EXPECT_TRUE(has(scene.err, {"20 of 20 pairs have another verdict"}));
  expect_done("graze fuzz --scene walls.toml --pairs 100" + lanes + "--out s > out");
  // Numbers that float32 holds are the same in doubles.
  std::ofstream(shell.folder / "plain.off") << "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n";
  expect_done("graze fuzz --mesh plain.off --coordinates both" + lanes + "--out p > out 2> err && test ! -s err");
  const Json plain = shell.json("p/summary.json")["strata"];
  for (const char* source : {"mesh", "mesh/f64"}) EXPECT_EQ(plain[source]["intersects"], 1) << source;
  expect_done("graze scene plain.off > plain.toml 2> err && test ! -s err");
}

TEST_F(Doubles, ACaseThatNamesAnotherPairHasChanged) {
  for (const char* stratum : {"near_edge_edge", "near_edge_edge/f64"}) {
    expect_done("graze dump " + std::string(stratum) + " --pairs 2 --format pairs > two.pairs");
    expect_done("graze repro two.pairs --lanes 'exact/*/cpu'");
    for (const char* edit : {"s/index=1/index=777/", "s/seed=1/seed=2/", "s/stratum=near_edge_edge/stratum=uniform/"}) {
      const Ran ran = shell("sed '" + std::string(edit) +
                            "' two.pairs > other.pairs && graze repro other.pairs --lanes "
                            "'exact/*/cpu'");
      EXPECT_EQ(ran.status, 1) << stratum << ' ' << edit << ran.out << ran.err;
      EXPECT_TRUE(has(ran.out, {"which is another pair"}));
    }
  }
}

TEST_F(Doubles, TheirScalesAndGroupsAreTheirOwnInAReport) {
  expect_done(
      "graze fuzz --coordinates both --strata extreme_scale,uniform --pairs 60k --lanes "
      "'moller_1997/*/cpu,exact/*/cpu' "
      "--out s && graze report s");
  const Json told = shell.json("s/report.json");
  std::map<std::string, int> steps;
  int ends_at_most = 0;
  for (const Json& row : told["extremes"]) {
    steps[row["kind"]] = row["step"];
    std::uint64_t pairs = 0;
    for (const Json& cell : row["cells"]) pairs += cell["wrong"]["of"].get<std::uint64_t>();
    EXPECT_EQ(pairs, 15000u) << row["kind"];
    const std::string lane = told["lanes"][row["lane"].get<std::size_t>()]["id"];
    const bool never = row["kind"] == "scale" ? lane.starts_with("exact/") : lane == "exact/f64/cpu";
    EXPECT_EQ(row["says"].get<std::string>().starts_with("errs on none of 15,000 pairs"), never) << row["says"];
    if (row["kind"] == "scale/f64")
      ends_at_most += row["says"].get<std::string>().find(" to 2^1024") != std::string::npos;
  }
  EXPECT_EQ(steps, (std::map<std::string, int>{{"scale", 4}, {"scale/f64", 32}}));
  EXPECT_GT(ends_at_most, 0);
  const std::string rates = shell.file("s/rates.csv");
  EXPECT_TRUE(has(rates, {"exact/f32/cpu,general/f64,uniform/f64,wrong,", "exact/f32/cpu,general,uniform,wrong,"}));
  EXPECT_FALSE(has(rates, {"exact/f32/cpu,general,uniform/f64,"}));
}

TEST_F(Doubles, NoReasonIsToldThatNobodySaw) {
  std::ofstream(shell.folder / "beyond.pairs") << "0 0 0  1 0 0  0 1 0   0 0 1  1 0 1  0 1e39 1\n";
  const std::string told =
      shell("graze explain beyond.pairs --lanes 'moller_1997/f32/cpu' | tr '\\n' ' ' | tr -s ' '").out;
  EXPECT_TRUE(has(told, {"float32 cannot store the pair (number 17, 1e+39, is beyond float32's range)"}));
  std::ofstream(shell.folder / "yes.c") << "int meet(const double* a, const double* b) { return 1; }\n";
  std::ofstream(shell.folder / "y.pairs") << "0 0 0 1 0 0 0 1 0  0 0 1 1 0 1 0 1 1 | coordinates=f64\n";
  const std::string own =
      shell("graze explain y.pairs --subject yes=./yes.c:meet --lanes 'yes/*' | tr '\\n' ' ' | tr -s ' '").out;
  EXPECT_TRUE(has(own, {"the code itself is wrong here, not its rounding (no sum and no product"}));
}

// An epsilon in a function of doubles is found from the function's verdicts on other doubles.
TEST_F(Doubles, ExperimentsFindAnEpsilonInOnesOwnCode) {
  std::ofstream(shell.folder / "near.c") << "#include <math.h>\n"
                                            "int meet(const double* a, const double* b) {\n"
                                            "  return fabs(b[2] - a[2]) <= 1e-6;\n"
                                            "}\n";
  std::ofstream(shell.folder / "near.pairs")
      << "0.1 0.2 0  1.3 0 0  0 1.7 0   0.1 0 1e-7  1.1 0 1e-7  0 1.9 1e-7 | coordinates=f64\n";
  const std::string own =
      shell("graze explain near.pairs --subject near=./near.c:meet --lanes 'near/*' | tr '\\n' ' ' | tr -s ' '").out;
  EXPECT_TRUE(has(own, {"an absolute epsilon decides", "with 1e-36 in place of 1e-6 at near.c:3 it is right"}));
  EXPECT_FALSE(has(own, {"perhaps"}));
}

// A campaign's case is refused if the campaign's strata cannot have drawn its pair.
TEST_F(Doubles, CasesOfOtherStrataAreRefused) {
  expect_done("graze fuzz --strata near_vertex_face --pairs 2000 --lanes 'moller_1997/f32/cpu' --out c");
  const Json summary = shell.json("c/summary.json");
  const std::string file = "c/" + summary["signatures"][0]["case"].get<std::string>();
  expect_done("sed -i '3,$s/stratum=[a-z_]* seed=1 index=[0-9]* /stratum=nosuch seed=99 index=12345678 /' " + file);
  expect_error("graze report c", 1, {file, "does not belong to the campaign"});
  expect_error("graze minimize c", 1, {file, "does not belong to the campaign"});
  // A case of the same signature from a campaign with another seed is refused too.
  expect_done("graze fuzz --strata near_vertex_face --pairs 2000 --lanes 'moller_1997/f32/cpu' --seed 2 --out d");
  expect_done("graze fuzz --strata near_vertex_face --pairs 2000 --lanes 'moller_1997/f32/cpu' --out e");
  const Ran both = shell("cd d && head -qn 2 cases/* | grep -F \"$(head -qn 2 ../e/cases/* | grep '^# ')\" | head -1");
  ASSERT_TRUE(both.out.starts_with("# ")) << both.err;  // a signature with the same count in both
  expect_done("cd d && cp \"$(grep -lF '" + both.out.substr(0, both.out.find('\n')) + "' cases/*)\" ../e/cases/");
  expect_error("graze report e", 1, {"does not belong to the campaign"});
}

TEST_F(Doubles, WhatStoringChangesIsSaid) {
  std::ofstream(shell.folder / "far.pairs")
      << "1000000.01 0 0 1000000.01 1 0 1000000.01 0 1  1000000.02 0 0 1000000.02 1 0 1000000.02 0 1 | "
         "coordinates=f64\n";
  const Ran ran = shell("graze check far.pairs --lanes 'exact/*/cpu' | tr -s ' \\n' ' '");
  EXPECT_TRUE(has(ran.out, {"truth: disjoint", "as stored in float32: they share an area", "number 1, 1000000.01"}));
  std::ofstream(shell.folder / "large.pairs") << "1e300 0 0 0 1e300 0 0 0 1e300 1 1 1 2 2 2 3 3 4\n";
  expect_out("graze check large.pairs --lanes 'exact/*/cpu,moller_1997/*/cpu' | tr -s ' \\n' ' '",
             {"float32 cannot store it: number 1, 1e+300"});
}

// A margin below the smallest double or above the largest is reported as such, never as a contact or as infinite.
TEST_F(Doubles, NoMarginIsZeroOrInfiniteByRounding) {
  std::ofstream(shell.folder / "ends.pairs")
      << "0x1p-1074 0 -0x1p-1074 0 0x1p-1074 -0x1p-1074 0 0 0x1p-1074  "
         "0 0 0 -0x1p-1074 -0x1p-1074 0 -0x1p-1074 0 -0x1p-1074 | coordinates=f64\n"
         "1e308 1e308 1e308 1e308 -1e308 1e308 1e308 0 -1e308  "
         "-1.7e308 -1.7e308 -1.7e308 -1.7e308 1.7e308 1.7e308 -1.7e308 0 -1.7e308 | coordinates=f64\n";
  const Ran ran = shell.done("graze check ends.pairs --lanes 'exact/f64/cpu' --json");
  std::istringstream lines(ran.out);
  for (const double margin : {0x1p-1074, 0x1.fffffffffffffp+1023}) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    const Json truth = Json::parse(line)["truth"];
    EXPECT_EQ(truth["verdict"], "disjoint");
    EXPECT_EQ(truth["margin"], margin) << line;
    EXPECT_GT(truth["margin_ulps"], 0.3);
  }
}

// Tests minimize, failures, explain and the report's cards on a campaign of doubles.
TEST_F(Doubles, FailuresAreMinimisedAndExplained) {
  expect_done(
      "graze fuzz --coordinates f64 --strata 'stored,near_vertex_face,lattice' --pairs 600 --lanes "
      "'moller_1997/*/cpu,guigue_devillers_2003/*/cpu' --out c > /dev/null && cp -r c d && graze minimize c --threads "
      "1 "
      "> /dev/null && graze minimize d --threads 4 > /dev/null && diff -r c/cases d/cases && cmp c/failures.json "
      "d/failures.json && graze report c");
  const Json report = shell.json("c/report.json");
  int stored = 0, computed = 0;
  for (const Json& card : report["cards"]) {
    const Json& kind = card["kind"];
    EXPECT_TRUE(card["minimised"]) << kind;
    EXPECT_EQ(card["maps"]["panels"][0]["name"], "truth") << card["maps"];
    if (kind["cause"] != "stored") {
      ++computed;
      continue;
    }
    ++stored;
    for (const std::string lane : kind["lanes"]) EXPECT_TRUE(has(lane, {"/f32/"}));
    // The card's command runs the pair in doubles.
    const std::string command = card["commands"][1]["text"];
    expect_out(command, {"float32 stores another pair, for which that is right"});
  }
  EXPECT_GT(stored, 1);
  EXPECT_GT(computed, 1);
  const Ran failures = shell("graze failures c");
  EXPECT_TRUE(has(failures.out, {"stored"})) << failures.err;
  expect_out("graze minimize stored/f64:1:3 --lanes 'guigue_devillers_2003/*/cpu' --out small.pairs",
             {"cause: stored, as before"});
  EXPECT_TRUE(has(shell.file("small.pairs"), {"coordinates=f64"}));
  // In this case's map, lanes in float decide what float32 stores, so many neighbouring cells are the same pair.
  expect_out("graze map small.pairs --lanes 'guigue_devillers_2003/*/cpu'", {"guigue_devillers_2003/f64/cpu"});
  const Ran why = shell.done("graze explain small.pairs --lanes 'guigue_devillers_2003/*/cpu' --json");
  const Json line = Json::parse(why.out.substr(0, why.out.find('\n')));
  EXPECT_EQ(line["lanes"][0]["cause"], "stored") << line;
  EXPECT_EQ(line["lanes"][0]["settled"], "yes");
  EXPECT_TRUE(has(line["pair"].get<std::string>(), {"coordinates=f64"}));
}

// The programs contain the exact doubles; a program for a lane in float rounds them when it reads them.
TEST_F(Doubles, CasesBecomePrograms) {
  std::ofstream(shell.folder / "near.pairs")
      << "0 0 1 1 0 1 0 1 1  0 0 0x1.0000000001p0 1 0 2 0 1 2 | coordinates=f64\n"  // they touch in float32
         "0.1 0.2 0.3 1.1 0.2 0.7 0.1 1.3 0.9  0.4 0.5 0.6 2.1 2.2 2.3 1.5 2.5 0.5 | coordinates=f64\n";
  const std::string repro = "graze repro near.pairs --lanes 'guigue_devillers_2003/f32/cpu' --emit ";
  expect_done(repro +
              "cpp > case.cpp && grep -q 0x1.0000000001p+0, case.cpp && g++ -std=c++20 -O3 -ffp-contract=off "
              "case.cpp -o case");
  const Ran wrong = shell("./case");
  EXPECT_EQ(wrong.status, 1) << wrong.out;
  EXPECT_TRUE(has(wrong.out, {"guigue_devillers_2003/f32: intersects; truth: disjoint"}));
  expect_done(repro + "python > case.py && python3 case.py && grep -q 'each number is a double' case.py");
  expect_done(repro + "cgal > cgal.cpp && g++ -std=c++20 cgal.cpp -lmpfr -lgmp -o cgal && ./cgal");
  expect_done(repro + "obj > case.obj && grep -q 1.0000000000009095 case.obj");
}

// Two triangles are 1e-10 apart. The coordinates of one triangle have few digits, those of the other have many. In
// either order, both triangles are decided as written.
TEST_F(Doubles, AllDecimalsOfTwoMeshesAreDoublesIfSomeHaveManyDigits) {
  std::ofstream(shell.folder / "few.off") << "OFF\n3 1 0\n0.1 0 0\n0.1 1 0\n0.1 0 1\n3 0 1 2\n";
  std::ofstream(shell.folder / "many.off") << "OFF\n3 1 0\n0.1000000001 0 0\n0.1000000001 1 0\n0.1000000001 0 1\n"
                                              "3 0 1 2\n";
  std::ofstream(shell.folder / "few.txt") << "0.1 0 0 0.1 1 0 0.1 0 1\n";
  for (const std::string command :
       {"graze query few.off many.off --between", "graze query many.off few.off --between",
        "graze query few.off#0 many.off", "graze query many.off#0 few.off", "graze query few.txt many.off"}) {
    const Ran ran = shell.done(command);
    EXPECT_TRUE(has(ran.out, {"0 "}));
    EXPECT_FALSE(has(ran.out, {"1 pair"})) << command;
    EXPECT_FALSE(has(ran.out, {"1 of 1"})) << command;
    EXPECT_TRUE(has(ran.err, {"many.off: decided in doubles"})) << command;
    EXPECT_FALSE(has(ran.err, {"rounded"})) << command;
  }
  for (const std::string meshes : {"few.off many.off", "many.off few.off"}) {
    expect_done("rm -rf f; graze fuzz --mesh " + meshes + " --coordinates f64 --lanes 'exact/*/cpu' --out f");
    const Json mesh = shell.json("f/summary.json")["strata"]["mesh/f64"];
    EXPECT_EQ(mesh["intersects"], 0) << meshes;
    EXPECT_EQ(mesh["lanes"]["exact/f32/cpu"]["stored"], 1) << meshes;
  }
}

TEST_F(Doubles, ARegressionCorpusKeepsThemBesideFloats) {
  expect_done(
      "graze fuzz --coordinates both --strata 'near_vertex_face,stored' --pairs 600 "
      "--lanes 'moller_1997/*/cpu,exact/*/cpu' --out c && graze corpus add c --top 3 --corpus r --lanes '*/cpu'");
  const std::string once = shell.file("r/cases.pairs");
  EXPECT_TRUE(has(once, {"exact_"}));
  std::size_t of_doubles = 0, of_floats = 0;
  for (const corpus::Entry& entry : corpus::read_pairs(shell.folder / "r/cases.pairs", PairTypes::both))
    ++(entry.doubles ? of_doubles : of_floats);
  EXPECT_GT(of_doubles, 1u);
  EXPECT_GT(of_floats, 0u);
  const Ran verified = shell.done(
      "graze corpus verify --corpus r --lanes '*/cpu,*/f64/cuda-fma,*/f64/cuda-fma/abs:1e-6' --executor twin");
  EXPECT_FALSE(has(verified.out, {"Not run"}));
  // By default, the exact lane for doubles is among the lanes.
  const auto lanes_of = [&](const char* lanes) {
    const Ran ran = shell.done(std::string("graze corpus verify --corpus r --executor twin") + lanes);
    return ran.out.substr(0, ran.out.find(" lanes: "));
  };
  EXPECT_EQ(lanes_of(""), lanes_of(" --lanes 'exact/f64/*,*'"));
  EXPECT_NE(lanes_of(""), lanes_of(" --lanes '*,!exact/f64/*'"));
  expect_done("graze corpus verify --corpus r --lanes '*/cpu' --update && graze corpus list --corpus r > /dev/null");
  EXPECT_EQ(shell.file("r/cases.pairs"), once);
  // A verdict that differs from the record is a change on a pair of doubles too.
  expect_done("sed -i '/coordinates=f64/s/\\(lanes=.*moller_1997:\\)[+-]f32/\\1.f32/' r/cases.pairs");
  EXPECT_NE(shell.file("r/cases.pairs"), once);
  const Ran changed = shell("graze corpus verify --corpus r --lanes 'moller_1997/f32/cpu'");
  EXPECT_EQ(changed.status, 1) << changed.out;
  EXPECT_TRUE(has(changed.out, {"moller_1997/f32/cpu: was "}));
  // A single pair can be added too.
  expect_done("graze corpus add stored/f64:1:3 --corpus s --lanes 'exact/*/cpu,moller_1997/*/cpu'");
  EXPECT_TRUE(has(shell.file("s/cases.pairs"), {"coordinates=f64"}));
}

TEST_F(Doubles, APolicyIsTunedOnThem) {
  const std::string strata = "--strata near_vertex_face,stored --pairs 2000 --coordinates f64 ";
  expect_done("graze tune moller_1997/f64/cpu --forbid false-negative " + strata + "--out t > told");
  const Json tuned = shell.json("t/tune.json");
  // A campaign with the chosen policy counts the same errors on the pairs on which `tune` verified the choice.
  const std::string lane = "moller_1997/f64/cpu/" + tuned["chosen"].get<std::string>();
  expect_done("graze fuzz --lanes '" + lane + "' " + strata + "--seed 2 --out c");
  const Json summary = shell.json("c/summary.json");
  for (const char* count : {"false_positive", "false_negative", "declined"}) {
    std::uint64_t counted = 0;
    for (const Json& stratum : summary["strata"]) counted += stratum["lanes"][lane][count].get<std::uint64_t>();
    EXPECT_EQ(tuned["confirmed"][count], counted) << lane << ' ' << count;
  }
  EXPECT_GT(tuned["confirmed"]["fixed"], 0);
  for (const char* file : {"t/fixed.pairs", "t/broken.pairs"})
    EXPECT_TRUE(has(shell.file(file), {"coordinates=f64"})) << file;
  const std::string told = shell.file("told");
  EXPECT_TRUE(has(told, {"exact/f64/cpu"}));
  const std::size_t next = told.find("Next: ");
  ASSERT_NE(next, std::string::npos);
  EXPECT_TRUE(has(shell(told.substr(next + 6)).out, {"moller_1997/f64"})) << told;
  // Tunes a CUDA lane without contraction, which runs as a twin.
  expect_done("graze tune moller_1997/f64/cuda-nofma --forbid false-negative " + strata + "--out w > told");
  EXPECT_EQ(shell.json("w/tune.json")["confirmed"], tuned["confirmed"]);
  // Tunes a lane in float on a campaign's own pairs, and two lanes with --agree.
  expect_done(
      "graze fuzz --lanes 'moller_1997/*/cpu*' --strata near_vertex_face --pairs 500 --coordinates both --out d");
  expect_done("graze tune moller_1997/f32/cpu --from d --out u");
  EXPECT_TRUE(has(shell.file("u/changes.csv"), {"near_vertex_face/f64,1,"}));
  expect_done("graze tune --agree moller_1997/f64/cpu moller_1997/f64/cpu-fma --max-rate 0.1 " + strata +
              "--out v > lines && tr '\\n' ' ' < lines > told");
  EXPECT_TRUE(has(shell.file("told"), {"exact/f64/cpu and exact/f64/cuda", "both lanes are moller_1997/f64/cpu."}));
  const Json agreed = shell.json("v/agree.json");
  EXPECT_EQ(agreed["zero_confirmed"]["pairs"], 2000);
  EXPECT_EQ(agreed["zero_confirmed"]["intersecting"], agreed["confirmed"]["intersecting"]);
}

TEST_F(Doubles, AnEpsilonOfOnesOwnIsTunedOnThem) {
  std::ofstream(shell.folder / "mine.c") << R"(#include <math.h>
// Compares each triangle only with the other's plane, with a coarse epsilon.
static double side(const double* p, const double* q) {
  const double eps = 1e-3;
  double u[3], v[3], n[3], all = 0, none = 0;
  for (int i = 0; i < 3; ++i) u[i] = p[3 + i] - p[i], v[i] = p[6 + i] - p[i];
  for (int i = 0; i < 3; ++i) n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
  for (int k = 0; k < 3; ++k) {
    double d = 0;
    for (int i = 0; i < 3; ++i) d += n[i] * (q[3 * k + i] - p[i]);
    all += d > eps, none += d < -eps;
  }
  return all == 3 || none == 3;
}
int intersects(const double* a, const double* b) { return !side(a, b) && !side(b, a); }
)";
  expect_done(
      "export XDG_CACHE_HOME=$PWD/cache; graze tune mine/f64/cpu --subject mine=./mine.c --coordinates f64 --strata "
      "near_vertex_face --pairs 3000 --out t");
  const Json tuned = shell.json("t/tune.json");
  EXPECT_EQ(tuned["epsilon"]["name"], "eps");
  EXPECT_LT(tuned["confirmed"]["false_positive"], tuned["zero_confirmed"]["false_positive"]);
  EXPECT_TRUE(has(shell.file("t/fixed.pairs"), {"coordinates=f64"}));
}

TEST_F(Doubles, ErrorsAndCostsAreMeasuredOnThem) {
  expect_done(
      "graze pareto --coordinates f64 --strata stored,near_vertex_face --pairs 2000 --lanes "
      "'moller_1997/*/cpu,exact/*/cpu' --out p");
  const Json found = shell.json("p/pareto.json");
  int failures = 0;
  for (const Json& lane : found["lanes"]) {
    const bool never = lane["lane"] == "exact/f64/cpu";
    EXPECT_EQ(lane["failure"].is_null(), never) << lane;
    EXPECT_EQ(lane["errors"]["false_positive"] == 0 && lane["errors"]["false_negative"] == 0, never) << lane;
    EXPECT_GT(lane["in_cache"]["middle"], 0) << lane;
    if (never) continue;
    std::ofstream(shell.folder / "f.pairs") << lane["failure"].get<std::string>() << '\n';
    const Ran checked = shell("graze check f.pairs --lanes " + lane["lane"].get<std::string>());
    EXPECT_TRUE(has(checked.out, {" !"})) << lane["failure"] << checked.err;
    ++failures;
  }
  EXPECT_EQ(failures, 3);
  EXPECT_EQ(found["lanes"].size(), 4u);
}

// A case of a lane in float is a pair of float32; a case of a lane in double is a pair of doubles. `check` confirms
// that the lane is wrong on each case.
TEST_F(Doubles, BrokenInvariantsAreCountedOnThem) {
  expect_done(
      "graze invariants --coordinates f64 --pairs 2800 --lanes "
      "'guigue*/*/cpu,exact/*/cpu' --out i");
  const Json found = shell.json("i/invariants.json");
  ASSERT_EQ(found["lanes"].size(), 4u);
  EXPECT_GT(found["truth"]["pairs"], 5000);  // each pair, and its float32 pair if float32 can store it
  for (const Json& lane : found["lanes"]) {
    const std::string id = lane["lane"];
    const Json& order = lane["invariants"]["order"];
    EXPECT_EQ(order["pairs"] == 2800, id.find("/f64/") != id.npos) << id;
    EXPECT_EQ(order["strata"].size(), 28u);
    EXPECT_EQ(order["strata"]["stored/f64"]["pairs"], 100);
    EXPECT_EQ(order["changed"] == 0, id.starts_with("exact/")) << id;
    if (order["changed"] == 0) continue;
    const std::string from = order["case"]["from"];
    EXPECT_EQ(from.ends_with("/f64, stored in float32"), id.find("/f32/") != id.npos) << from;
    const Ran checked = shell("graze check i/cases/order.pairs --json --lanes '" + id + "'");
    std::istringstream lines(checked.out);
    bool wrong = false;
    for (std::string line; std::getline(lines, line);) {
      const Json pair = Json::parse(line);
      wrong = wrong || pair["lanes"][id] != pair["truth"]["verdict"];
    }
    EXPECT_TRUE(wrong) << checked.out << checked.err;
  }
}

// For both types, the user's code differs from the exact lane as often as the campaign counts errors. A comparison with
// a later campaign shows on which pairs of doubles the code's verdict changed.
TEST_F(Doubles, VerdictsOfOnesOwnCodeAreComparedOnThem) {
  std::ofstream(shell.folder / "mine.c") << "int meet(const double* a, const double* b) { return a[0] > b[0]; }\n"
                                            "int meet_f(const float* a, const float* b) { return a[0] > b[0]; }\n";
  const std::string drawn = " --coordinates f64 --strata stored,uniform --pairs 1000 --out ";
  for (const std::string& scalar : {std::string("f64"), std::string("f32")}) {
    const std::string subject = scalar == "f64" ? "mine=mine.c:meet" : "mine=mine.c:meet_f";
    const std::string lane = "mine/" + scalar + "/cpu", exact = "exact/" + scalar + "/cpu";
    expect_done("graze discrepancy " + lane + " " + exact + " --subject " + subject + drawn + "d_" + scalar);
    expect_done("graze fuzz --lanes '" + lane + "," + exact + "' --subject " + subject + drawn + "c_" + scalar);
    const Json found = shell.json("d_" + scalar + "/discrepancy.json")["verdicts"][0];
    const Json summary = shell.json("c_" + scalar + "/summary.json");
    for (const auto& [stratum, row] : found["strata"].items()) {
      EXPECT_TRUE(stratum.ends_with("/f64")) << stratum;
      const Json& lanes = summary["strata"][stratum]["lanes"];
      for (const auto& [of, id] : {std::pair{"of_first", lane}, {"of_second", exact}}) {
        for (const char* error : {"false_positive", "false_negative"})
          EXPECT_EQ(row[of].value(error, 0), lanes[id][error]) << id << stratum << error;
      }
      EXPECT_GT(row["differs"], 0) << stratum;
    }
    EXPECT_EQ(found["total"]["of_second"].value("false_positive", 0) == 0, scalar == "f64");  // only due to storing
  }
  std::ofstream(shell.folder / "mine.c") << "int meet(const double* a, const double* b) { return 1; }\n";
  expect_done("graze fuzz --lanes 'mine/*,exact/*' --subject mine=mine.c:meet" + drawn + "later");
  expect_done("graze report --compare c_f64 later");
  std::uint64_t broken = 0, mended = 0;
  const Json compared = shell.json("later/compare.json")["compare"]["verdicts"];
  for (const Json& row : compared) {
    if (row["known"] == "same") continue;
    broken += row["broken"].get<std::uint64_t>();
    mended += row["mended"].get<std::uint64_t>();
    EXPECT_TRUE(row["smallest_mended"].get<std::string>().starts_with(row["stratum"].get<std::string>() + ":1:"))
        << row;
  }
  EXPECT_GT(broken, 0u);
  EXPECT_GT(mended, 0u);
}

// The verb finds as many differing verdicts as a campaign on the same pairs. Lanes in float are left out and named.
TEST_F(Doubles, ValuesOfLanesInDoubleAreComparedOnThem) {
  const std::string first = "moller_1997/f64/cpu", second = "moller_1997/f64/cuda-fma",
                    compare = "graze discrepancy " + first + " " + second + " --executor twin ",
                    drawn = " --coordinates f64 --strata near_edge_edge,construction_born --pairs 4001 --out ";
  expect_done("graze fuzz --lanes " + first + "," + second + " --executor twin" + drawn + "c");
  expect_done(compare + "--campaign c --pairs 4001");
  expect_done(compare + drawn + "d");
  expect_done("cmp c/discrepancy.json d/discrepancy.json");
  const Json summary = shell.json("c/summary.json"), found = shell.json("c/discrepancy.json");
  EXPECT_EQ(found["coordinates"], "f64");
  const Json& of = found["lanes"][0];
  EXPECT_EQ(of["strata"].size(), 2u);
  for (const auto& [stratum, row] : of["strata"].items()) {
    EXPECT_EQ(row["pairs"], summary["strata"][stratum]["pairs"]) << stratum;
    EXPECT_EQ(row["verdict"], summary["strata"][stratum]["lanes"][second]["differs_from_cpu"]) << stratum;
    EXPECT_GT(row["verdict"], 5) << stratum;
  }
  EXPECT_TRUE(has(shell.file("c/discrepancy.html"), {"4,001 pairs of triangles, with coordinates in double"}));
  expect_done("graze report c");
  const std::string other_pairs = "that the campaign did not draw";
  EXPECT_FALSE(has(shell.file("c/report.html"), {other_pairs}));

  // For some source line, the simplest pair whose verdict that line changes is a pair of doubles.
  bool in_doubles = false;
  for (const Json& line : of["origins"]["lines"]) {
    if (line["simplest"].is_null()) continue;
    for (const std::string number : line["simplest"]["hex"]) {
      const double x = std::strtod(number.c_str(), nullptr);
      in_doubles = in_doubles || static_cast<double>(static_cast<float>(x)) != x;
    }
  }
  EXPECT_TRUE(in_doubles) << of["origins"]["lines"];
  const Ran all =
      shell.done("graze discrepancy --executor twin --coordinates both --strata stored,thesis --pairs 90 --out e");
  const Json of_all = shell.json("e/discrepancy.json");
  EXPECT_EQ(of_all["coordinates"], "both");
  EXPECT_EQ(of_all["lanes"].size(), 10u);
  EXPECT_EQ(of_all["lanes"][0]["strata"].size(), 3u);  // thesis, thesis/f64 and stored/f64
  for (const Json& lanes : of_all["lanes"]) EXPECT_TRUE(has(lanes["first"].get<std::string>(), {"/f64/"}));
  EXPECT_TRUE(has(all.err, {"moller_1997/f32/cuda-fma"}));
  EXPECT_EQ(of_all["lanes_left_out"]["why"].size(), 15u);  // cpu, cuda-fma and cuda-nofma of five algorithms
  expect_done("graze discrepancy --executor twin --strata thesis --pairs 90 --out f");
  EXPECT_FALSE(shell.json("f/discrepancy.json").contains("coordinates"));
  expect_error("graze discrepancy --compare e f", 2, {"strata"});
  expect_error("graze dump stored/f64:1 --pairs 2 --values moller_1997/f32/cpu,moller_1997/f32/cpu-fma", 2,
               {"stored/f64", "float32"});

  std::ofstream(shell.folder / "m.off") << "OFF\n6 2 0\n0.1 0 0\n1 0 0.1\n0 1.3 0\n0.2 0.2 -0.7\n0.3 0.2 1\n2 2 1.1\n"
                                           "3 0 1 2\n3 3 4 5\n";
  expect_done("graze fuzz --mesh m.off --coordinates f64 --lanes " + first + " --out m");
  expect_done(compare + "--campaign m");
  const Json of_mesh = shell.json("m/discrepancy.json");
  EXPECT_EQ(of_mesh["pairs"], 1);
  EXPECT_EQ(of_mesh["coordinates"], "f64");
}

// A lane in float decides the pair that float32 stores, so its verdict is explained on that pair.
TEST_F(Doubles, AFloatLanesCauseIsOfTheStoredPair) {
  std::ofstream(shell.folder / "p.pairs")
      << "0 1.1920928955078125 0 1 0 0 -1 0 0 0 1.1920928359031677 1 0 1.1920928955078125 0 0 1.1920928955078125 -1 | "
         "coordinates=f64\n";
  const std::string explain = "graze explain p.pairs --lanes 'moller_1997/*/cpu'";
  const Ran json = shell(explain + " --json"), told = shell(explain);
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_TRUE(has(json.out, {": on the pair as float32 stores it, the algorithm itself is wrong here"}));
  EXPECT_TRUE(has(told.out, {"on the stored pair: no number of"}));
  EXPECT_TRUE(has(shell("graze check p.pairs --lanes 'exact/f64/*'").out, {"exact/f64"}));
}

TEST_F(Doubles, AreSearchedByAHunt) {
  const std::string hunt =
      "graze hunt --coordinates f64 --runs 1500 --seed 3 --lanes 'moller_1997/*/cpu,exact/*/cpu' --out h";
  const Ran first = shell(hunt);
  if (first.err.find("libFuzzer") != std::string::npos) GTEST_SKIP() << "this build has no libFuzzer";
  ASSERT_EQ(first.status, 0) << first.err;
  const Json summary = shell.json("h/summary.json");
  const Json& lanes = summary["strata"]["hunt/f64"]["lanes"];
  EXPECT_GT(lanes["exact/f32/cpu"]["stored"], 30);
  EXPECT_GT(lanes["moller_1997/f64/cpu"]["false_negative"], 10);
  for (const char* wrong : {"false_positive", "false_negative", "declined"})
    EXPECT_EQ(lanes["exact/f64/cpu"][wrong], 0);
  const std::string file = summary["signatures"][0]["case"];
  const Ran again = shell("graze repro h/" + file);
  EXPECT_TRUE(has(again.out, {"(as recorded)"})) << again.err;
  EXPECT_TRUE(has(shell.file("h/" + file), {"stratum=hunt/f64 seed=3 index="}));
  expect_done("graze minimize h && graze failures h && graze report h");
  const Json report = shell.json("h/report.json");
  EXPECT_EQ(report["run"]["command"].dump().find("graze hunt --runs 1500 --seed 3 --coordinates f64"), 1u);
  EXPECT_EQ(report["strata"][0]["describes"], "pairs that guided search made from all strata of doubles");
  const std::string before = shell.file("h/summary.json");
  expect_done(hunt + " && graze corpus add h --corpus k --top 3 --lanes '*/cpu'");
  EXPECT_EQ(shell.file("h/summary.json"), before);
  expect_error("graze hunt --coordinates both --out b", 2, {"--coordinates", "both"});
  write_survey();
  expect_done("graze hunt --scene survey.toml --runs 300 --seed 3 --lanes 'moller_1997/*/cpu,exact/*/cpu' --out s");
  const Json survey = shell.json("s/summary.json");
  EXPECT_EQ(survey["strata"]["hunt/f64"]["pairs"], 300);
  expect_done("graze repro s/" + survey["signatures"][0]["case"].get<std::string>());
  expect_within_survey(shell.file("s/" + survey["signatures"][0]["case"].get<std::string>()));
}

// A scene file names the type of its pairs. A case from a campaign in the scene can be drawn again by name.
TEST_F(Doubles, ASceneIsDrawnInItsDoubles) {
  write_survey();
  const std::string lanes = "--lanes 'moller_1997/*/cpu,exact/*/cpu' ";
  const std::string fuzz = "graze fuzz --scene survey.toml --pairs 6000 " + lanes;
  expect_out(fuzz + "--threads 2 --out one", {"  large_offset/f64: your coordinates stay within 0 … 5400300 m\n"});
  const Json summary = shell.json("one/summary.json");
  EXPECT_EQ(summary["spec"]["strata"].size(), 16u) << summary["spec"]["strata"];
  std::uint64_t pairs = 0, stored = 0;
  for (const auto& [id, row] : summary["strata"].items()) {
    EXPECT_TRUE(id.ends_with("/f64")) << id;
    pairs += row["pairs"].get<std::uint64_t>();
    stored += row["lanes"]["exact/f32/cpu"].value("stored", std::uint64_t{0});
    for (const char* wrong : {"false_positive", "false_negative", "declined"})
      EXPECT_EQ(row["lanes"]["exact/f64/cpu"][wrong], 0) << id;
  }
  EXPECT_EQ(pairs, 6000u);
  EXPECT_GT(stored, 600u);  // float32 has steps of half a metre there
  // A campaign that is killed and resumed has the same bytes; one that is merged from shards has the same counts.
  for (const int write : {5, 15})
    ASSERT_EQ(shell(signal_at_write(SIGKILL, write) + fuzz + "--threads 1 --out two").status, 128 + SIGKILL) << write;
  expect_done(fuzz + "--threads 1 --out two && cmp one/summary.json two/summary.json && diff -r one/cases two/cases");
  expect_done(fuzz + "--shard 1/2 --out p1 && " + fuzz + "--shard 2/2 --out p2 && graze merge p1 p2 --out merged");
  EXPECT_EQ(shell.json("merged/summary.json")["strata"], summary["strata"]);
  // A case records its origin, and each of its names draws it again.
  const std::string file = "one/" + summary["signatures"][0]["case"].get<std::string>();
  const std::string text = shell.file(file);
  expect_within_survey(text);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex("stratum=(\\S+) seed=(\\d+) index=(\\d+) scene=(\\S+) ")))
      << text;
  const std::string id = found[1], numbers = ":" + found[2].str() + ":" + found[3].str(), scene = found[4];
  EXPECT_TRUE(scene.starts_with("survey.toml#")) << scene;
  expect_out("graze repro " + file, {"(as recorded)"});
  const auto vertices_of = [&](const std::string& name) {
    const Ran repro = shell.done("graze repro '" + name + "' --emit obj");
    return repro.out.substr(std::min(repro.out.find("\nv "), repro.out.size()));
  };
  const std::string vertices = vertices_of(file);
  EXPECT_GT(vertices.size(), 60u);
  for (const std::string& of : {scene, std::string("survey.toml"), std::string("one")})
    EXPECT_EQ(vertices_of(id + '@' + of + numbers), vertices) << of;
  // The verbs that accept a campaign accept this one.
  expect_done("graze minimize one > minimised && graze failures one > kinds && graze report one > report");
  EXPECT_TRUE(has(shell.file("one/failures.json"), {"/f64@survey.toml#"}));
  const std::string command = shell.json("one/report.json")["run"]["command"];
  EXPECT_TRUE(has(command, {"--scene survey.toml --pairs 6000 --seed 1 --coordinates f64 --lanes"}));
  expect_done(command.substr(0, command.find("--out")) + "--out one && cmp one/summary.json two/summary.json");
  const Ran dumped = shell("graze dump one --pairs 30 --format pairs");
  EXPECT_TRUE(has(dumped.out, {"scene=" + scene})) << dumped.err;
  expect_within_survey(dumped.out);
  expect_done("graze pack one --out one.sqlar && graze tune moller_1997/f64/cpu --from one --pairs 500 --out from");
  // Pairs of both types, in a scene where float32 is fine enough.
  std::ofstream(shell.folder / "hall.toml") << "extent = [-20, 20]\nedges = [0.5, 4]\n";
  expect_done("graze fuzz --scene hall.toml --coordinates both --pairs 600 --strata uniform,near_edge_edge " + lanes +
              "--out b && graze report b");
  const Json both = shell.json("b/summary.json");
  for (const char* source : {"uniform", "uniform/f64", "near_edge_edge", "near_edge_edge/f64"})
    EXPECT_NEAR(both["strata"][source]["pairs"].get<int>(), 150, 1) << source;
  const std::string of_both = shell.json("b/report.json")["run"]["command"];
  expect_done(of_both.substr(0, of_both.find("--out")) + "--out b2 && cmp b/summary.json b2/summary.json");
}

// A mesh with numbers that float32 cannot hold becomes a scene of doubles, whose mesh pairs are not rounded.
TEST_F(Doubles, AMeshOfDoublesBecomesASceneOfDoubles) {
  std::ofstream off(shell.folder / "site.off");
  off << "OFF\n36 50 0\n";
  for (int i = 0; i < 36; ++i)
    off << fmt::format("{:.2f} {:.2f} {:.2f}\n", 500000.25 + i % 6 * 0.37, 5400000.01 + i / 6 * 0.41, i * i % 7 * 0.13);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      const int v = 6 * i + j;
      off << fmt::format("3 {} {} {}\n3 {} {} {}\n", v, v + 1, v + 7, v, v + 7, v + 6);
    }
  }
  off.close();
  const Ran ran = shell.done("graze scene site.off --units m --out site.toml");
  EXPECT_TRUE(has(ran.err, {"have more digits than float32 holds"}));
  const std::string text = shell.file("site.toml");
  EXPECT_TRUE(has(text, {"\ncoordinates = \"f64\"\n", "\nextent = [[500000.25, 500002.1], [5400000.01, 5400002.06], ",
                         "\ngrid = { decimals = 2 }\n"}));
  expect_done("graze fuzz --scene site.toml --pairs 900 --lanes 'moller_1997/*/cpu,exact/*/cpu' --out s");
  const Json strata = shell.json("s/summary.json")["strata"];
  for (const char* source : {"mesh/f64", "mesh_ulps/f64", "mesh_moved/f64", "shared_edge/f64"})
    EXPECT_GT(strata[source]["pairs"], 0) << source;
  // The mesh's own pairs are those that `graze fuzz --mesh` draws, in another order.
  expect_done("graze fuzz --mesh site.off --coordinates f64 --lanes 'moller_1997/*/cpu,exact/*/cpu' --out m");
  const Json of_mesh = shell.json("m/summary.json")["strata"]["mesh/f64"];
  expect_done(
      "graze fuzz --scene site.toml --strata mesh --pairs 100k --lanes 'moller_1997/*/cpu,exact/*/cpu' --out own");
  EXPECT_EQ(shell.json("own/summary.json")["strata"]["mesh/f64"]["lanes"], of_mesh["lanes"]);
  // float32 must be requested by name; here it is too coarse for a scene.
  expect_error("graze fuzz --scene site.toml --coordinates f32 --out f", 2, {"float32", "8 ulps", "doubles"});
  EXPECT_TRUE(has(shell("graze scene site.off --coordinates f32").err, {"8 ulps"}));
  expect_done("graze scene site.off --coordinates f64 | sed 1,3d | cmp - <(sed 's/\"m\"/\"units\"/;1,3d' site.toml)");
  // Pairs of doubles are measured too.
  expect_done("graze dump m --format pairs > m.pairs && graze scene m.pairs | grep -q '^coordinates = \"f64\"'");
}

// Every verb that draws doubles can draw them in a scene.
TEST_F(Doubles, EveryVerbDrawsAScenesDoubles) {
  write_survey();
  std::ofstream(shell.folder / "mine.c") << "int meet(const double* a, const double* b) { return a[0] < b[0]; }\n";
  std::ofstream(shell.folder / "subjects.txt") << "mine=mine.c:meet\n";
  expect_done("graze tune moller_1997/f64/cpu --scene survey.toml --pairs 2000 --out t | tee told");
  EXPECT_TRUE(has(shell.file("told"), {"large_offset/f64: your coordinates"}));
  expect_done("graze pareto --scene survey.toml --pairs 1000 --lanes 'moller_1997/f64/cpu,exact/f64/cpu' --out p");
  expect_done("graze invariants --scene survey.toml --pairs 200 --lanes 'exact/f64/cpu' --out i");
  const Json invariants = shell.json("i/invariants.json");
  EXPECT_EQ(invariants["scene"], "survey.toml");
  expect_done("graze league --subjects subjects.txt --scene survey.toml --pairs 300 --out l");
  EXPECT_TRUE(has(shell.file("l/league.md"), {"--scene survey.toml --coordinates f64"}));
  expect_done("graze plan --scene survey.toml --pairs 1e6 --lanes 'exact/f64/cpu'");
  expect_done("graze plan --coordinates both --pairs 1e6 --lanes 'exact/f64/cpu'");
  expect_done(
      "graze discrepancy mine/f64/cpu exact/f64/cpu --subject mine=mine.c:meet --scene survey.toml --pairs 500 "
      "--out d");
  EXPECT_TRUE(shell.json("d/discrepancy.json")["verdicts"][0]["strata"].contains("uniform/f64"));
  // Each refusal gives its reason.
  expect_error("graze discrepancy moller_1997/f32/cpu moller_1997/f32/cpu-fma --scene survey.toml", 2,
               {"only on pairs of float32"});
  expect_error("graze fuzz --scene survey.toml --strata large_offset --out n", 2, {"large_offset/f64", "5400300"});
  expect_error("sed 's/, 30]/, 3]/' survey.toml > fine.toml; graze explain uniform@fine.toml:1:2", 2,
               {"float32", "8 ulps", "doubles"});
}

// In a fresh campaign on the scene's doubles, the lane that --sufficient names stays within the rate.
TEST_F(Doubles, WhatSufficesIsJudgedOnAScenesDoubles) {
  write_survey();
  const Ran ran = shell("graze scene survey.toml --sufficient 0.05 | tr '\\n' ' '");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      ran.out, found,
      std::regex("(?:use|that suffices is):? ([a-z_0-9]+/f64/cpu[^,]*), at 95 % confidence wrong on under")))
      << ran.out << ran.err;
  EXPECT_TRUE(has(ran.out, {"exact/f64/cpu", "No published lane of f32 is shown to suffice"}));
  const std::string lane = found[1];
  expect_done("graze fuzz --scene survey.toml --pairs 40k --seed 77 --lanes " + lane + " --out fresh");
  const Json summary = shell.json("fresh/summary.json");
  double wrong = 0, pairs = 0;
  for (const auto& [source, row] : summary["strata"].items()) {
    EXPECT_TRUE(source.ends_with("/f64")) << source;
    pairs += row["pairs"].get<double>();
    for (const char* kind : {"false_positive", "false_negative"}) wrong += row["lanes"][lane][kind].get<double>();
  }
  EXPECT_LE(wrong, 0.05 * pairs) << lane;
}

// Code that compares only boxes, in double and in float. On a site in UTM coordinates, the code in double gets doubles.
TEST_F(Doubles, TryTakesTheDoublesOfCodeInDouble) {
  write_survey();
  for (const char* real : {"double", "float"}) {
    std::ofstream(shell.folder / (std::string(real) + ".cpp"))
        << "#include <algorithm>\nbool meet(const " << real << " p[9], const " << real
        << " q[9]) {\n  for (int i = 0; i < 3; ++i)\n    if (std::max({p[i], p[i + 3], p[i + 6]}) + 1e-9 < "
           "std::min({q[i], q[i "
           "+ 3], q[i + 6]}) ||\n        std::max({q[i], q[i + 3], q[i + 6]}) < std::min({p[i], p[i + 3], p[i + 6]}))\n"
           "      return false;\n  return true;\n}\n";
  }
  std::ofstream(shell.folder / "walls.off")
      << "OFF\n9 3 0\n500000.25 5400000.01 0\n500003.25 5400000.01 0\n500000.25 5400000.01 3\n500000.25 5400000.02 "
         "0\n500003.25 5400000.02 0\n500000.25 5400000.02 3\n500001.25 5399999.01 1\n500001.25 5400001.01 1\n500001.25 "
         "5399999.01 3\n3 0 1 2\n3 3 4 5\n3 6 7 8\n";
  const auto tried = [&](const std::string& arguments) {
    const Ran ran = shell.done("export XDG_CACHE_HOME=$PWD/cache; graze try " + arguments + " --pairs 300 --json");
    return Json::parse(ran.out, nullptr, false);
  };
  for (const std::string in : {"walls.off", "survey.toml", "--coordinates f64"}) {
    const Json answer = tried("double.cpp:meet " + in);
    EXPECT_EQ(answer["lane"], "double/f64/cpu") << in;
    EXPECT_GT(answer["wrong"]["count"], 25) << in;
    EXPECT_EQ(answer["test"], "try/case.cpp") << in;
    EXPECT_EQ(answer["nanoseconds_a_call"]["exact"]["lane"], "exact/f64/cpu") << in;
    EXPECT_TRUE(has(answer["epsilon"].get<std::string>(), {"1e-9"})) << answer["epsilon"];
    const Json strata = shell.json("try/summary.json")["strata"];
    for (const auto& [source, row] : strata.items()) {
      EXPECT_TRUE(source.ends_with("/f64")) << source;
      const Json lanes = row["lanes"];
      ASSERT_TRUE(lanes.contains("exact/f64/cpu"));
    }
    const std::string file = answer["failures"][0]["case"];
    EXPECT_TRUE(has(shell.file(file), {"coordinates=f64"})) << file;
    expect_done("export XDG_CACHE_HOME=$PWD/cache; graze explain " + file);
    EXPECT_EQ(answer["again"].get<std::string>().find("--coordinates f64") != std::string::npos, in.starts_with("--"))
        << answer["again"];
  }
  // The output names the exact lane of doubles, and its command for more pairs keeps the coordinate type.
  const Ran screen =
      shell("export XDG_CACHE_HOME=$PWD/cache; graze try double.cpp:meet --coordinates f64 --pairs 300 --out screen");
  EXPECT_TRUE(has(screen.out, {"Instead: exact/f64/cpu is right on all 300 pairs."}));
  // By default, code in float gets the mesh rounded to float32. If the user asks for doubles, errors from that rounding
  // count as the code's own.
  tried("float.cpp:meet walls.off --out f");
  EXPECT_TRUE(shell.json("f/summary.json")["strata"].contains("mesh"));
  tried("float.cpp:meet survey.toml --out g");
  const Json stored = shell.json("g/summary.json")["strata"]["uniform/f64"]["lanes"];
  EXPECT_TRUE(stored["float/f32/cpu"].contains("stored")) << stored;
}

TEST_F(Doubles, VerbsThatTakeFloat32AloneSaySo) {
  expect_done(kCampaign);
  for (const auto& [command, word] : std::map<std::string, std::string>{
           {"graze discrepancy moller_1997/f32/cpu moller_1997/f32/cpu-fma --campaign c", "moller_1997/f32/cpu"}})
    expect_error(command, 2, {word});
  expect_error("graze fuzz --coordinates f16 --out m", 2, {"f16"});
  expect_error("graze prove-twin --coordinates both", 2, {"--coordinates", "f64"});
  expect_error("graze dump nothing/f64", 2, {"nothing/f64"});
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "m"));
}

}  // namespace
}  // namespace graze::cli
