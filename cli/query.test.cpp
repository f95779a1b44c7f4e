// SPDX-License-Identifier: Apache-2.0
// `graze query` and `graze bench` as users run them.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/run_graze.h"
#include "strata/strata.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

// A square of two triangles, and triangles that pierce it, touch it in a point, share a vertex with it, or are far
// away.
constexpr const char* kMesh = R"(v 0 0 0
v 4 0 0
v 4 4 0
v 0 4 0
v 3 1 -1
v 3 1 1
v 3.5 1 1
v 3 2 0
v 1 2 5
v 2 1 5
v 0 0 3
v 0 -3 3
v 9 9 9
v 9 8 9
v 9 9 8
f 1 2 3
f 1 3 4
f 5 6 7
f 8 9 10
f 1 11 12
f 13 14 15
)";

class QueryCommand : public CommandTest {
 protected:
  QueryCommand() {
    std::ofstream(shell.folder / "mesh.obj") << kMesh;
    std::ofstream(shell.folder / "ref.txt") << "# the square's first half\n0 0 0, 4 0 0,\n4 4 0\n";
  }

  Json json(const std::string& command) const {
    const Ran ran = shell.done(command);
    return Json::parse(ran.out);
  }

  std::string out(const std::string& command) const {
    const Ran ran = shell.done(command);
    return ran.out;
  }
};

TEST_F(QueryCommand, FindsAllOrAny) {
  EXPECT_EQ(out("graze query ref.txt mesh.obj"),
            "5 of 6 triangles meet the reference, the first is 0 (exact, one-core)\n");
  EXPECT_EQ(out("graze query mesh.obj#3 mesh.obj --executor all-cores"),
            "2 of 6 triangles meet the reference, the first is 0 (exact, all-cores)\n");
  expect_error("graze query mesh.obj mesh.obj", 2, {"mesh.obj#0", "--self mesh.obj"});
  EXPECT_EQ(out("graze query mesh.obj#5 mesh.obj --any"), "triangle 5 meets the reference (exact, one-core)\n");
  EXPECT_EQ(out("echo 99 99 99 98 99 99 99 98 99 > far; graze query far mesh.obj --any"),
            "no triangle of 6 meets the reference (exact, one-core)\n");
  EXPECT_EQ(out("cat far >> ref.txt; graze query ref.txt mesh.obj"),
            "5 hits among 6 triangles and 2 references, the first is 0 (exact, one-core)\n");
}

TEST_F(QueryCommand, JsonIsOneObject) {
  const Json found = json("graze query mesh.obj#3 mesh.obj --json");
  EXPECT_EQ(found["triangles"], 6);
  EXPECT_EQ(found["hits"], 2);
  EXPECT_EQ(found["first"], 0);
  EXPECT_EQ(found["declined"], 0);
  EXPECT_GT(found["seconds"], 0);
  EXPECT_EQ(found["lane"], "exact");
  EXPECT_TRUE(json("echo 99 99 99 98 99 99 99 98 99 > far; graze query far mesh.obj --json")["first"].is_null());
}

TEST_F(QueryCommand, WritesHits) {
  expect_done("graze query mesh.obj#3 mesh.obj --obj hits.obj --pairs hits.pairs");
  const std::string obj = shell.file("hits.obj");
  EXPECT_TRUE(
      obj.starts_with("# Written by graze query\ng reference\nv 3 2 0\nv 1 2 5\nv 2 1 5\nf 1 2 3\ng hits\nv 0 0 0\n"))
      << obj;
  EXPECT_EQ(json("graze query mesh.obj#3 hits.obj --json")["hits"], 3);  // the reference is in the file too
  expect_done("graze query mesh.obj#3 mesh.obj --pairs /dev/stdout 2>&1 | cat > piped; grep '^0x' hits.pairs > h");
  expect_done("grep -q . h && grep '^0x' piped | cmp - h");  // a pipe has no path
  const Ran checked = shell("graze check hits.pairs --truth-only | grep -c 'truth: intersects'");
  EXPECT_EQ(checked.out, "2\n");
}

// The README's example: the triangles share a vertex, but one algorithm says disjoint.
TEST_F(QueryCommand, SeveralLanesAreComparedAndMismatchesAreCases) {
  std::ofstream(shell.folder / "mesh.obj") << "v .1 .2 .3\nv .5 .5 .9\nv -.3 .8 .4\nv 9 9 9\nf 1 2 3\nf 4 2 3\n";
  std::ofstream(shell.folder / "ref.txt") << "0.1 0.2 0.3  0.4 0.9 0.2  0.7 0.1 0.6\n";
  EXPECT_EQ(out("graze query ref.txt mesh.obj --lanes 'exact,guigue*/f32/cpu,guigue*/f32/cpu/filtered'"),
            "1 of 2 triangles meets the reference, the first is 0 (exact, one-core)\n"
            "0 of 2 triangles meet the reference (guigue_devillers_2003/f32/cpu, one-core)\n"
            "1 of 2 triangles meets the reference, the first is 0 (guigue_devillers_2003/f32/cpu/filtered, one-core)\n"
            "                                                                       differ on\n"
            "exact                          guigue_devillers_2003/f32/cpu                   1\n"
            "exact                          guigue_devillers_2003/f32/cpu/filtered          0\n"
            "guigue_devillers_2003/f32/cpu  guigue_devillers_2003/f32/cpu/filtered          1\n"
            "1 mismatch, 1 of them kept in mismatches.pairs\nNext: graze explain mismatches.pairs\n");
  const std::string kept = shell.file("mismatches.pairs");
  EXPECT_TRUE(has(kept, {"said_by_exact=intersects said_by_guigue_devillers_2003_f32_cpu=disjoint "
                         "said_by_guigue_devillers_2003_f32_cpu_filtered=intersects\n"}));
  expect_done("graze explain mismatches.pairs --lanes '*/f32/cpu'");
  expect_error("graze query ref.txt mesh.obj --pairs x --mismatches ./x", 2, {"--pairs", "--mismatches", "./x"});
  expect_done("graze minimize mismatches.pairs --lanes 'guigue*/f32/cpu' --out small.pairs");
  const Json found = json("graze query ref.txt mesh.obj --lanes exact --executor one-core,all-cores --json");
  EXPECT_EQ(found["mismatches"], 0);
  EXPECT_EQ(found["others"][0]["executor"], "all-cores");
  EXPECT_EQ(found["others"][0]["hits"], found["hits"]);
}

// For each combination of two runs, counts the mismatches again from the verdicts of single runs.
TEST_F(QueryCommand, CudaLanesRunByTheirTwinsAndAreComparedTwoByTwo) {
  if (shell("graze lanes | grep -q 'available (device)'").status == 0) GTEST_SKIP() << "a device runs these lanes";
  std::string text;
  for (int i = 0; i < 20000; ++i) {
    const Pair pair = strata::generate(7, strata::Stratum::thesis, static_cast<std::uint64_t>(i));
    for (const auto& v : pair.b) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    text += fmt::format("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
  }
  std::ofstream(shell.folder / "thesis.obj") << text;
  const Pair first = strata::generate(7, strata::Stratum::thesis, 0);
  std::ofstream(shell.folder / "ref.txt")
      << fmt::format("{} {} {} {} {} {} {} {} {}\n", first.a[0].x, first.a[0].y, first.a[0].z, first.a[1].x,
                     first.a[1].y, first.a[1].z, first.a[2].x, first.a[2].y, first.a[2].z);
  const std::vector<std::string> lanes = {"interval_overlap/f32/cpu", "interval_overlap/f32/cuda-nofma",
                                          "interval_overlap/f32/cuda-fma"};
  const Json found = json(
      "graze query ref.txt thesis.obj --lanes 'interval_overlap/f32/cpu,interval_overlap/f32/cuda-*fma' "
      "--executor one-core --json --mismatches m.pairs");
  EXPECT_EQ(found["others"][1]["lane"], lanes[2]);
  EXPECT_TRUE(found["others"][1]["evidence"].get<std::string>().starts_with("twin, ")) << found;
  EXPECT_FALSE(found.contains("evidence"));
  std::vector<std::vector<std::string>> hits;
  for (const std::string& lane : lanes) {
    expect_done("graze query ref.txt thesis.obj --lanes '" + lane + "' --pairs hits.pairs");
    std::istringstream names(out("grep -o 'name=[^ ]*' hits.pairs | sort"));
    hits.emplace_back(std::istream_iterator<std::string>(names), std::istream_iterator<std::string>());
  }
  std::size_t row = 0;
  for (std::size_t r = 0; r < lanes.size(); ++r) {
    for (std::size_t s = r + 1; s < lanes.size(); ++s, ++row) {
      std::vector<std::string> apart;
      std::set_symmetric_difference(hits[r].begin(), hits[r].end(), hits[s].begin(), hits[s].end(),
                                    std::back_inserter(apart));
      EXPECT_EQ(found["differing"][row]["triangles"], apart.size());
      EXPECT_EQ(found["differing"][row]["lanes"], Json({lanes[r], lanes[s]}));
    }
  }
  EXPECT_EQ(found["differing"][0]["triangles"], 0);  // without contraction CPU and GPU agree
  EXPECT_GT(found["differing"][1]["triangles"], 0);
  const Ran ran =
      shell.done("graze query ref.txt thesis.obj --executor one-core --lanes 'interval_overlap/f32/cuda-f*'");
  EXPECT_TRUE(ran.out.ends_with("(interval_overlap/f32/cuda-fma, one-core, by its twin)\n")) << ran.out;
  EXPECT_TRUE(has(ran.err, {"left out (no twin; a CUDA device runs it): interval_overlap/f32/cuda-fast"}));
  expect_error("graze query ref.txt thesis.obj --lanes interval_overlap/f32/cuda-fast", 2, {"cuda-fast", "no twin"});
}

TEST_F(QueryCommand, SelfTellsPiercingFromNeighbours) {
  EXPECT_EQ(out("graze query --self mesh.obj"),
            "6 triangles: 1 pair pierces each other, 1 touches otherwise\n"
            "neighbours that share only an edge: 1; only a vertex: 2\n"
            "the first pair that pierces: triangles 0 and 2\n");
  const Json found = json("graze query --self mesh.obj --json --pairs p.pairs --obj p.obj");
  EXPECT_EQ(found["first"], Json({0, 2}));
  EXPECT_EQ(found["common_edge"], 1);
  EXPECT_TRUE(has(out("graze check p.pairs --truth-only"), {"contact segment"}));
  EXPECT_EQ(
      json("printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n' > one.obj; graze query --self one.obj --json")["hits"],
      0);
  // A mesh that is folded onto itself, and contains one triangle twice.
  EXPECT_EQ(json("printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv .1 .2 0\\nf 1 2 3\\nf 1 2 4\\nf 2 3 1\\n' > f.obj; "
                 "graze query --self f.obj --json")["hits"],
            3);
}

// Neighbours that share more than their common vertex, but do not pierce each other: an edge along an edge, in one
// plane and in two, and an edge inside a triangle. Then a pair that pierces.
TEST_F(QueryCommand, NeighboursThatOnlyTouchDoNotPierce) {
  const std::string corner = "printf 'v 0 0 0\nv 4 0 0\nv 0 4 0\n";
  const auto self = [&](const std::string& others) {
    const Json found = json(corner + others + "' > n.obj; graze query --self n.obj --json");
    EXPECT_EQ(found["hits"].get<int>() + found["touching"].get<int>(), 1) << others;
    EXPECT_EQ(found["common_edge"].get<int>() + found["common_vertex"].get<int>(), 0) << others;
    return found["hits"] == 1;
  };
  EXPECT_FALSE(self("v 2 0 0\nv 1 -3 0\nf 1 2 3\nf 1 4 5\n"));
  EXPECT_FALSE(self("v 2 0 0\nv 0 0 4\nf 1 2 3\nf 1 4 5\n"));
  EXPECT_FALSE(self("v 1 1 0\nv 0 0 4\nf 1 2 3\nf 1 4 5\n"));
  EXPECT_TRUE(self("v 1 1 -1\nv 1 1 1\nf 1 2 3\nf 1 4 5\n"));
  EXPECT_TRUE(self("v 1 1 0\nv 1 3 0\nf 1 2 3\nf 1 4 5\n"));  // coplanar, with a common area
}

TEST_F(QueryCommand, ErrorsAreOneLine) {
  expect_error("graze query", 2, {"two files", "0"});
  expect_error("graze query ref.txt", 2, {"two files", "1"});
  expect_error("graze query ref.txt no.obj", 1, {"no.obj", "No such file or directory"});
  expect_error("graze query no.txt mesh.obj", 1, {"no.txt", "No such file or directory"});
  expect_error("mkfifo pipe; timeout 60 graze query pipe mesh.obj", 1, {"pipe", "not a regular file"});
  expect_error("graze query /dev/null mesh.obj", 1, {"/dev/null", "not a regular file"});
  expect_error("echo 1 2 3 > r; graze query r mesh.obj", 1, {"r", "3"});
  expect_error("echo 1 2 x > r; graze query r mesh.obj", 1, {"r:1", "\"x\""});
  expect_error("graze query mesh.obj#6 mesh.obj", 1, {"mesh.obj", "6", "6"});
  expect_error("graze query mesh.obj#a mesh.obj", 2, {"'a'"});
  expect_error("graze query ref.txt mesh.obj --lanes nosuch", 2, {"'nosuch'"});
  expect_error("graze query ref.txt mesh.obj --executor twin", 2, {"'twin'"});
  expect_error("graze query ref.txt mesh.obj --any --lanes '*/f32/cpu'", 2, {"--any", "one lane"});
  expect_error("graze query ref.txt mesh.obj --any --pairs p", 2, {"--any", "--obj", "--pairs"});
  expect_error("graze query --self mesh.obj --any", 2, {"--self", "--any", "--lanes", "--executor"});
  expect_error("graze query --self mesh.obj ref.txt", 2, {"--self"});
  expect_error("mkdir d; graze query ref.txt mesh.obj --pairs d", 1, {"d"});
  if (shell("graze query ref.txt mesh.obj --executor one-gpu").status != 0)
    expect_error("graze query ref.txt mesh.obj --executor one-gpu", 1, {"no CUDA device"});
}

TEST_F(QueryCommand, BenchMeasuresAndCompares) {
  const Json found = json(
      "graze bench --triangles 1e3,2e4 --mesh mesh.obj --lanes interval_overlap/f32/cpu,exact/f32/cpu --json --plot "
      "speed.svg");
  EXPECT_GE(found["machine"]["threads"], 1);
  int exact = 0, in_doubles = 0, others = 0, trees = 0;
  std::uint64_t hits = 0;
  for (const Json& row : found["rows"]) {
    EXPECT_GT(row["seconds"], 0);
    EXPECT_NEAR(row["per_second"].get<double>() * row["seconds"].get<double>(), row["triangles"].get<double>(), 1);
    const bool of_20000 = row["triangles"] == 20000 && row["mode"] == "all";
    if (row["lane"] == "exact" && of_20000) {
      hits = row["hits"];
      ++exact;
    }
    if (row["lane"] == "exact/f32/cpu" || (row["lane"] == "exact, doubles" && row["data"] == "host")) {
      EXPECT_EQ(row["mismatches"], 0);
    }
    in_doubles += row["lane"] == "exact, doubles" && of_20000;
    if (row["lane"] == "interval_overlap/f32/cpu" && of_20000 && row["executor"] == "one core") {
      EXPECT_GT(row["mismatches"], 0);
      ++others;
    }
    if (row["lane"] == "CGAL AABB tree" && of_20000) {
      ++trees;
      EXPECT_LE(row["hits"], hits);  // without degenerate triangles
      EXPECT_GT(row["hits"].get<double>(), 0.95 * static_cast<double>(hits));
    }
    if (row["lane"] == "Embree" && of_20000) {
      EXPECT_EQ(row["hits"], hits);
    }
    if (row["mode"] == "any") {
      EXPECT_EQ(row["hits"], 1);
    }
  }
  EXPECT_GE(exact, 1);
  EXPECT_EQ(in_doubles, exact);
  EXPECT_GE(others, 1);
  EXPECT_EQ(trees, 1);
  std::set<std::string> executors;
  for (const Json& row : found["rows"]) {
    if ((row["lane"] == "exact" || row["lane"] == "interval_overlap/f32/cpu") && row["mode"] == "all" &&
        row["array"] == "thesis" && row["data"] != "resident, split")
      executors.insert(row["lane"].get<std::string>() + ", " + row["executor"].get<std::string>() +
                       (row["data"] == "resident" ? ", resident" : ""));
  }
  const std::string plot = out("cat speed.svg");
  for (const std::string& executor : executors) EXPECT_TRUE(has(plot, {">" + executor + "</text>"}));
  const auto count = [&](const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = 0; (at = plot.find(what, at)) != plot.npos; ++at) ++n;
    return n;
  };
  EXPECT_EQ(count("<polyline"), executors.size());
  EXPECT_EQ(count("<circle"), 2 * executors.size());  // two sizes
  EXPECT_TRUE(has(out("graze bench --triangles 1000"), {"thesis, 1,000"}));
  expect_error("graze bench --triangles 0", 2, {"--triangles", "'0'", "1"});
  expect_error("graze bench --mesh no.obj", 1, {"no.obj", "No such file or directory"});
  expect_error("graze bench --triangles 10 --lanes nosuch", 2, {"'nosuch'"});
  const Json large = json("graze bench --triangles 1000001 --lanes moller_1997/f32/cpu --json");
  EXPECT_EQ(large["not_timed_above"], Json({{"moller_1997/f32/cpu", 1'000'000}}));
  EXPECT_TRUE(found["not_timed_above"].empty());
  if (shell("graze lanes | grep -q 'available (device)'").status == 0) return;
  const Ran ran = shell("graze bench --triangles 1000 --lanes 'interval_overlap/f32/cuda-f*' --json");
  EXPECT_EQ(ran.err, "graze: left out (no twin; a CUDA device runs it): interval_overlap/f32/cuda-fast\n");
  bool by_twin = false;
  const Json twins = Json::parse(ran.out);
  for (const Json& row : twins["rows"]) {
    if (row["lane"] == "interval_overlap/f32/cuda-fma") by_twin |= row["executor"] == "one core, twin";
  }
  EXPECT_TRUE(by_twin);
}

}  // namespace
}  // namespace graze::cli
