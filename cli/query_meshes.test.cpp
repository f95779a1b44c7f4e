// SPDX-License-Identifier: Apache-2.0
// `graze query --self` and `--between` as users run them. Brute force with the oracle checks every pair in every
// output.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/run_graze.h"
#include "core/relation_of.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;
template <class Real>
using TriangleOf = std::array<Vec3<Real>, 3>;
using Triangle = TriangleOf<float>;
using Triangles = std::vector<Triangle>;

template <class Real>
bool is_finite(const TriangleOf<Real>& t) {
  return std::all_of(t.begin(), t.end(), [](const Vec3<Real>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  });
}

// Returns the CSV row, from the oracle and an independent count of common vertices; empty for disjoint triangles.
template <class Real>
std::string row_of(std::size_t i, std::size_t j, const TriangleOf<Real>& a, const TriangleOf<Real>& b) {
  const BasicPair<Real> pair{{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
  const oracle::Truth truth = oracle::truth(pair);
  if (!truth.intersects()) return "";
  std::set<std::array<Real, 3>> of_a, both;
  constexpr Real kZero = 0;  // added, so that -0 becomes 0
  for (const Vec3<Real>& v : a) of_a.insert({v.x + kZero, v.y + kZero, v.z + kZero});
  for (const Vec3<Real>& v : b) {
    if (of_a.contains({v.x + kZero, v.y + kZero, v.z + kZero})) both.insert({v.x + kZero, v.y + kZero, v.z + kZero});
  }
  const bool piercing = truth.margin_sign < 0 || truth.contact == Contact::area;
  const char* kind = both.size() == 1 && truth.contact == Contact::point     ? "common_vertex"
                     : both.size() == 2 && truth.contact == Contact::segment ? "common_edge"
                     : piercing                                              ? "pierces"
                                                                             : "touches";
  return fmt::format("{},{},{},{}\n", i, j, name(truth.contact), kind);
}

template <class Real>
std::string by_oracle(const std::vector<TriangleOf<Real>>& a, const std::vector<TriangleOf<Real>>& b, bool self) {
  std::string csv = "i,j,contact,kind\n";
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = self ? i + 1 : 0; j < b.size(); ++j) {
      if (is_finite<Real>(a[i]) && is_finite<Real>(b[j])) csv += row_of<Real>(i, j, a[i], b[j]);
    }
  }
  return csv;
}

class QueryMeshes : public CommandTest {
 protected:
  // Writes the triangles with all their digits.
  template <class Real>
  void write(const std::string& file, const std::vector<TriangleOf<Real>>& triangles) const {
    constexpr int kDigits = std::numeric_limits<Real>::max_digits10;
    std::ofstream out(shell.folder / file);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (const Vec3<Real>& v : triangles[i])
        out << fmt::format("v {1:.{0}g} {2:.{0}g} {3:.{0}g}\n", kDigits, v.x, v.y, v.z);
      out << fmt::format("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
  }

  Json json(const std::string& command) const {
    const Ran ran = shell.done(command);
    return Json::parse(ran.out, nullptr, false);
  }

  std::uint64_t rows(const std::string& csv, const std::string& end = "") const {
    std::uint64_t count = 0;
    std::istringstream in(csv);
    for (std::string line; std::getline(in, line);) count += line.ends_with(end);
    return end.empty() ? count - 1 : count;
  }

  // Compares every output of both searches with brute force.
  template <class Real>
  void expect_as_by_oracle(const std::vector<TriangleOf<Real>>& a, const std::vector<TriangleOf<Real>>& b,
                           const std::string& what) const {
    SCOPED_TRACE(what);
    write("a.obj", a);
    write("b.obj", b);
    const std::string between = by_oracle<Real>(a, b, false), self = by_oracle<Real>(a, a, true);
    for (const std::string executor : {"one-core", "all-cores"}) {
      const Json found = json("graze query a.obj b.obj --between --csv ab.csv --json --executor " + executor);
      EXPECT_EQ(shell.file("ab.csv"), between);
      EXPECT_EQ(found["hits"], rows(between));
      EXPECT_EQ(found["list"].size(), rows(between));
      EXPECT_EQ(found["touching"], rows(between, "touches"));
      EXPECT_EQ(found["common_vertex"], rows(between, "common_vertex"));
      EXPECT_EQ(found["declined"], std::count_if(a.begin(), a.end(), std::not_fn(is_finite<Real>)) +
                                       std::count_if(b.begin(), b.end(), std::not_fn(is_finite<Real>)));
      EXPECT_EQ(found["coordinates"], sizeof(Real) == sizeof(float) ? "f32" : "f64");
      const Json within = json("graze query --self a.obj --csv aa.csv --json --executor " + executor);
      EXPECT_EQ(shell.file("aa.csv"), self);
      EXPECT_EQ(within["hits"], rows(self, "pierces"));
      EXPECT_EQ(within["common_edge"], rows(self, "common_edge"));
    }
  }
};

// Triangles from all strata, in one region; some are degenerate or coplanar, and some share vertices.
TEST_F(QueryMeshes, FindThePairsOfBruteForceWithTheOracle) {
  Triangles a, b;
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::uint64_t i = 0; i < 6; ++i) {
      const Pair pair = strata::generate(5, row.stratum, i);
      a.push_back({pair.a[0], pair.a[1], pair.a[2]});
      b.push_back({pair.b[0], pair.b[1], pair.b[2]});
    }
  }
  ASSERT_GT(a.size(), 100u);
  expect_as_by_oracle(a, b, "strata");
  for (const char* kind : {"point,touches", "segment,pierces", "area,pierces", "point,common_vertex"})
    EXPECT_GT(rows(shell.file("ab.csv"), kind), 0u) << kind;

  Triangles lattice, other;  // touching and coplanar everywhere
  for (int i = 0; i < 60; ++i) {
    const auto at = [i](int k) { return static_cast<float>((i * 7 + k * k * 3 + i * k * 5) % 4); };
    lattice.push_back({{{at(0), at(1), 0}, {at(2), at(3), at(4) < 2 ? 0.0f : 1.0f}, {at(5), at(6), 0}}});
    other.push_back({{{at(7), at(8), 0}, {at(9), at(10), 0}, {at(11), at(12), at(13)}}});
  }
  expect_as_by_oracle(lattice, other, "lattice");

  Triangles broken = a;
  broken[3][1].y = NAN;
  broken[4][0].x = -INFINITY;
  expect_as_by_oracle(broken, b, "not finite");
  expect_as_by_oracle<float>({a[0]}, {b[0]}, "one face");
  expect_as_by_oracle(lattice, lattice, "the same mesh twice");
  Triangles moved = lattice;
  for (Triangle& t : moved) {
    for (Vec3<float>& v : t) v.z = std::nextafter(v.z, 9.0f);
  }
  expect_as_by_oracle(lattice, moved, "shifted by an ulp");
}

// Doubles for which storing in float32 changes many verdicts. With 17 digits they are read back bit for bit.
TEST_F(QueryMeshes, DecideDoublesAsTheOracleDoes) {
  std::vector<TriangleOf<double>> a, b;
  int changed = 0;
  for (const strata::StratumInfo& row : strata::kDoubleStrata) {
    if (row.stratum == strata::Stratum::extreme_scale) continue;  // beyond the range of float32
    for (std::uint64_t i = 0; i < 4; ++i) {
      const DoublePair pair = strata::generate_doubles(5, row.stratum, i);
      a.push_back({pair.a[0], pair.a[1], pair.a[2]});
      b.push_back({pair.b[0], pair.b[1], pair.b[2]});
      changed += relation_of(stored_in_float32(pair)).verdict != relation_of(pair).verdict;
    }
  }
  ASSERT_GT(changed, 20);
  expect_as_by_oracle(a, b, "strata of doubles");

  // The files contain the triangles that were decided.
  write("a.obj", std::vector<TriangleOf<double>>{a[0], a[1]});
  expect_done("graze query a.obj a.obj --between --obj hits.obj --pairs hits.pairs");
  std::istringstream hits(shell.file("hits.pairs"));
  std::string first, number;
  std::getline(hits, first);                // the version
  for (int k = 0; k < kCoordinates; ++k) {  // the first triangle and itself
    ASSERT_TRUE(hits >> number);
    EXPECT_EQ(std::strtod(number.c_str(), nullptr), component(a[0][static_cast<std::size_t>(k % 9 / 3)], k % 3));
  }
  expect_done("graze query --self hits.obj --json > again.json");
  EXPECT_EQ(Json::parse(shell.file("again.json"), nullptr, false)["coordinates"], "f64");

  // A user's question: two parallel triangles that are 0.01 apart, at coordinates of a million.
  std::ofstream(shell.folder / "far.off") << "OFF\n6 2 0\n1000000.01 0 0\n1000000.01 1 0\n1000000.01 0 1\n"
                                             "1000000.02 0 0\n1000000.02 1 0\n1000000.02 0 1\n3 0 1 2\n3 3 4 5\n";
  EXPECT_EQ(json("graze query --self far.off --json")["hits"], 0);
}

// Enough triangles for several slabs, blocks and threads: strips of a plane, and needles through it.
TEST_F(QueryMeshes, GiveTheSameBytesWhateverTheThreads) {
  Triangles plane, needles;
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 200; ++j) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      plane.push_back({{{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}}});
      if (j % 4 == 0) needles.push_back({{{x, y, -1}, {x, y, 1}, {x + 0.25f, y + 0.25f, i % 2 ? 0.0f : 3.0f}}});
    }
  }
  write("a.obj", plane);
  write("b.obj", needles);
  expect_done("graze query a.obj b.obj --between --executor one-core --csv one.csv");
  expect_done("graze query a.obj b.obj --between --csv all.csv && cmp one.csv all.csv");
  const std::string csv = shell.file("one.csv");
  EXPECT_EQ(rows(csv), 30'000u - 50 - 200);  // each needle meets three, except at two edges of the plane
  expect_done("graze query --self a.obj --executor one-core --csv self1.csv");
  expect_done("graze query --self a.obj --csv self2.csv && cmp self1.csv self2.csv");
  EXPECT_EQ(rows(shell.file("self1.csv"), "segment,common_edge"), 0u);

  // More hits than one JSON object lists.
  expect_done("graze query a.obj a.obj --between --csv aa.csv");
  const Json found = json("graze query a.obj a.obj --between --json");
  EXPECT_EQ(found["hits"], rows(shell.file("aa.csv")));
  EXPECT_EQ(found["list"].size(), 100000u);
  EXPECT_EQ(found["not_listed"], found["hits"].get<std::uint64_t>() - 100000u);
  EXPECT_EQ(found["list"][0], Json({{"i", 0}, {"j", 0}, {"contact", "area"}, {"kind", "pierces"}}));
  std::string listed = "i,j,contact,kind\n";
  for (const Json& hit : found["list"])
    listed += fmt::format("{},{},{},{}\n", hit["i"].get<int>(), hit["j"].get<int>(), hit["contact"].get<std::string>(),
                          hit["kind"].get<std::string>());
  EXPECT_TRUE(shell.file("aa.csv").starts_with(listed));
}

constexpr const char* kRoof = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3\nf 1 3 4\n";
constexpr const char* kPost = "v 3 1 -1\nv 3 1 1\nv 3.5 1 1\nv 0 0 0\nv 0 0 5\nv -1 0 5\nf 1 2 3\nf 4 5 6\n";

TEST_F(QueryMeshes, WriteEveryOutput) {
  std::ofstream(shell.folder / "roof.obj") << kRoof;
  std::ofstream(shell.folder / "post.obj") << kPost;
  const Ran ran = shell("graze query roof.obj post.obj --between --csv p.csv --obj p.obj --pairs p.pairs");
  EXPECT_EQ(ran.out,
            "2 and 2 triangles: 3 pairs intersect (all-cores)\n"
            "1 pierces each other, 0 share only an edge, 2 only a vertex, 0 touch otherwise\n"
            "the first pair: triangle 0 of roof.obj and 0 of post.obj\n");
  EXPECT_EQ(shell.file("p.csv"),
            "i,j,contact,kind\n0,0,segment,pierces\n0,1,point,common_vertex\n1,1,point,common_vertex\n");
  EXPECT_EQ(shell("grep -c '^f' p.obj").out, "6\n");
  EXPECT_EQ(shell("grep -o 'name=[^ ]*' p.pairs").out, "name=triangles_0_0\nname=triangles_0_1\nname=triangles_1_1\n");
  // A reference's hits, with the index of the reference first.
  expect_done("graze query roof.obj#0 post.obj --csv r.csv");
  EXPECT_EQ(shell.file("r.csv"), "i,j,contact,kind\n0,0,segment,pierces\n0,1,point,common_vertex\n");
  const Json found = json("graze query roof.obj#0 post.obj --json");
  EXPECT_EQ(found["list"], Json({0, 1}));
  EXPECT_EQ(found["not_listed"], 0);
  EXPECT_FALSE(json("graze query roof.obj#0 post.obj --any --json").contains("list"));
  const Ran far = shell.done(
      "printf 'v 9 9 9\\nv 8 9 9\\nv 9 8 9\\nf 1 2 3\\n' > far.obj; "
      "graze query roof.obj far.obj --between --json");
  EXPECT_TRUE(Json::parse(far.out)["first"].is_null());
}

TEST_F(QueryMeshes, SayWhatIsWrong) {
  std::ofstream(shell.folder / "roof.obj") << kRoof;
  const std::string between = "graze query roof.obj ";
  expect_error(between + "--between", 2, {"--between", "two meshes", "1"});
  expect_error(between + "roof.obj roof.obj --between", 2, {"--between", "3"});
  expect_error(between + "roof.obj --between --self roof.obj", 2, {"--self"});
  expect_error(between + "roof.obj --between --any", 2, {"--between", "--any"});
  expect_error(between + "roof.obj --between --lanes exact", 2, {"--between", "--lanes"});
  expect_error(between + "roof.obj --between --executor one-core,all-cores", 2, {"--between", "--executor"});
  expect_error(between + "roof.obj --between --executor all-gpus", 2, {"one GPU"});
  expect_error(between + "roof.obj --between --csv x --pairs ./x", 2, {"--csv", "--pairs", "./x"});
  expect_error("graze query roof.obj#0 roof.obj --any --csv x", 2, {"--any", "--csv"});
  expect_error("echo mine > kept; " + between + "roof.obj --between --csv kept", 2, {"kept", "--force"});
  expect_error(between + "none.off --between", 1, {"none.off", "No such file or directory"});
  expect_error(between + "roof.txt --between", 1, {"roof.txt"});
  expect_error("mkdir d.obj; " + between + "d.obj --between", 1, {"d.obj", "Is a directory"});
  expect_error("printf 'OFF\\n3 0 0\\n0 0 0\\n1 0 0\\n0 1 0\\n' > empty.off; " + between + "empty.off --between", 1,
               {"no triangle", "empty.off"});
  expect_error("printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 4\\n' > far.obj; " + between + "far.obj --between", 1,
               {"far.obj:4", "4", "3"});
  expect_error("truncate -s 4000G huge.off; " + between + "huge.off --between", 1, {"huge.off", "memory"});
  expect_error(between + "roof.obj --between --csv no/p.csv", 1, {"no/p.csv", "No such file or directory"});
  if (shell("graze lanes | grep -q 'available (device)'").status != 0)
    expect_error(between + "roof.obj --between --executor one-gpu", 1, {"--executor one-gpu", "no CUDA device"});
}

// If all boxes overlap, there are billions of candidates, which take minutes to decide. Ctrl+C ends the search at once
// and leaves no file.
TEST_F(QueryMeshes, EndInOrderWhenInterrupted) {
  Triangles soup;
  for (int i = 0; i < 60'000; ++i) {
    const auto x = static_cast<float>(i % 1000), y = static_cast<float>(i / 1000);
    soup.push_back({{{x, y, 0}, {1000 - x, 1000, x}, {1000, 1000 - y, 1000 + y}}});
  }
  write("soup.obj", soup);
  for (const std::string question : {"--self soup.obj", "soup.obj soup.obj --between"}) {
    for (const std::string signal : {"INT", "TERM"}) {
      const Ran ran = signalled("graze query " + question + " --csv p.csv --json", signal);
      EXPECT_EQ(ran.status, 130) << ran.err;
      EXPECT_EQ(ran.out, "");
      EXPECT_TRUE(has(ran.err, {"interrupted after"}));
      EXPECT_FALSE(std::filesystem::exists(shell.folder / "p.csv"));
      EXPECT_EQ(shell("ls | grep -c part").out, "0\n");
    }
  }
}

TEST_F(QueryMeshes, BenchFindsThePairsOfCgal) {
  std::ofstream(shell.folder / "roof.obj") << kRoof << "f 1 2 2\n";  // and a degenerate triangle
  std::ofstream(shell.folder / "post.obj") << kPost;
  const Json found = json("graze bench --between roof.obj post.obj --json");
  std::set<std::string> lanes;
  for (const Json& row : found["rows"]) {
    lanes.insert(row["lane"]);
    EXPECT_EQ(row["mode"], "between");
    EXPECT_EQ(row["array"], "roof.obj, post.obj");
    if (row["lane"] != "boxes alone") {
      EXPECT_EQ(row["hits"], 4);
      EXPECT_EQ(row["mismatches"], 0);
    }
  }
  EXPECT_EQ(lanes, (std::set<std::string>{"exact", "CGAL do_intersect", "boxes alone"}));
  expect_error("graze bench --between roof.obj", 2, {"--between"});
  expect_error("graze bench --between roof.obj none.off", 1, {"none.off", "No such file or directory"});
}

}  // namespace
}  // namespace graze::cli
