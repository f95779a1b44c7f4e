// SPDX-License-Identifier: Apache-2.0
// Tests meshes as input: every format gives the same triangles, the candidates are those of a brute-force search, and
// errors give the reason.
#include "strata/mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "core/message_testing.h"
#include "strata/mesh_readers/lines.h"
#include "strata/testing.h"

namespace graze::strata {
namespace {

using Index = std::pair<std::uint32_t, std::uint32_t>;
using Triangle = std::array<Vec3<float>, 3>;
using testing::boxes_overlap;

// The four faces of a tetrahedron with a corner at the origin.
const std::string kTetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";

class MeshFile : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }

  std::string contents(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  // Returns: the error message without the folder.
  std::string error_of(const std::string& name) const {
    std::string message = "none";
    try {
      read_bodies({folder_ / name});
    } catch (const std::runtime_error& error) {
      message = error.what();
    }
    const std::string prefix = folder_.string() + '/';
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }

 private:
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("graze_mesh_test_" + std::to_string(getpid()));
};

std::string off_of(const std::vector<Triangle>& triangles) {
  std::string text = "OFF\n" + std::to_string(3 * triangles.size()) + ' ' + std::to_string(triangles.size()) + " 0\n";
  for (const Triangle& t : triangles) {
    for (const auto& v : t) {
      text += std::to_string(v.x) + ' ' + std::to_string(v.y) + ' ' + std::to_string(v.z) + '\n';
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    text += "3 " + std::to_string(3 * i) + ' ' + std::to_string(3 * i + 1) + ' ' + std::to_string(3 * i + 2) + '\n';
  }
  return text;
}

std::string binary_stl_of(const std::vector<Triangle>& triangles) {
  std::string bytes(80, ' ');
  const auto append = [&bytes](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  const auto count = static_cast<std::uint32_t>(triangles.size());
  append(&count, sizeof count);
  for (const Triangle& t : triangles) {
    const Vec3<float> normal{};
    append(&normal, sizeof normal);
    append(t.data(), sizeof t);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST_F(MeshFile, EveryFormatReadsTheSameTriangles) {
  const std::vector<Triangle> expected = read_bodies({write("t.off", kTetrahedron)}).triangles;
  ASSERT_EQ(expected.size(), 4u);
  EXPECT_EQ(expected[3], (Triangle{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));

  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1/1 3/2 4/3\nf -3 -2 -1\n";
  EXPECT_EQ(read_bodies({write("t.obj", obj)}).triangles, expected);

  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";
  EXPECT_EQ(read_bodies({write("t.ply", ply)}).triangles, expected);

  std::string stl = "solid t\n";
  for (const Triangle& t : expected) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const auto& v : t) {
      stl += "vertex " + std::to_string(v.x) + ' ' + std::to_string(v.y) + ' ' + std::to_string(v.z) + '\n';
    }
    stl += "endloop\nendfacet\n";
  }
  EXPECT_EQ(read_bodies({write("t.STL", stl + "endsolid t\n")}).triangles, expected);
  EXPECT_EQ(read_bodies({write("binary.stl", binary_stl_of(expected))}).triangles, expected);
}

// In OFF, OBJ and STL files, campaigns refuse a vertex that is not finite, but queries read it.
TEST_F(MeshFile, VerticesThatAreNotFiniteAreReadOnRequest) {
  const float nan = std::nanf(""), infinity = HUGE_VALF;
  const Triangle bad{{{0, nan, 0}, {1, 0, -infinity}, {0, 1, 0}}}, good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  write("m.off", off_of({bad, good}));
  write("m.obj", "v 0 nan 0\nv 1 0 -inf\nv 0 1 0\nv 0 0 0\nv 1 0 0\nf 1 2 3\nf 4 5 3\n");
  write("m.stl", binary_stl_of({bad, good}));
  for (const std::string name : {"m.off", "m.obj", "m.stl"}) {
    EXPECT_NE(error_of(name).find("finite"), std::string::npos) << name;
    const auto read = read_triangles(write(name, contents(name)), Coordinates::any).triangles;
    ASSERT_EQ(read.size(), 2u) << name;
    EXPECT_TRUE(std::isnan(read[0][0].y)) << name;
    EXPECT_EQ(read[0][1].z, -infinity) << name;
    EXPECT_EQ(read[1], good) << name;
  }
}

TEST_F(MeshFile, AMeshAgainstItselfPairsEachTwoOnce) {
  const MeshPairs pairs = read_bodies({write("t.off", kTetrahedron)});
  EXPECT_EQ(pairs.candidates, (std::vector<Index>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  const Pair pair = pairs.pair(2);
  EXPECT_EQ((Triangle{pair.a[0], pair.a[1], pair.a[2]}), pairs.triangles[0]);
  EXPECT_EQ((Triangle{pair.b[0], pair.b[1], pair.b[2]}), pairs.triangles[3]);
}

// If one file needs doubles, the other file's short decimals are kept as doubles too.
TEST_F(MeshFile, HasTheDoublesOfDecimals) {
  const auto file = write("m.obj", "v 0.1 0 0\nv 1 0 0\nv 0 1 0\nv 0.1 0.7 0\nf 1 2 3\nf 1 2 4\n");
  const MeshPairs one = read_bodies({file});
  EXPECT_EQ(one.double_pair(0).a[0].x, 0.1);
  EXPECT_EQ(one.double_pair(0).b[2].y, 0.7);
  EXPECT_EQ(one.pair(0).a[0].x, 0.1f);
  const auto far = write("far.obj", "v 0.1000000001 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(read_bodies({file, far}).double_pair(0).a[0].x, 0.1);
  EXPECT_EQ(read_bodies({file, far}).double_pair(0).b[0].x, 0.1000000001);
}

// Decimals that a program prints for a float32 are not counted as beyond float32; decimals with more digits are.
TEST_F(MeshFile, KeepsDoublesBeyondFloat32) {
  const auto read = [&](const std::string& x) {
    const auto file = write("m.obj", "v " + x + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    return read_triangles(file);
  };
  for (const char* x : {"0.1", "0.100000001", "3.14159", "0.5", "16777216", "1e-45", "123456.789"}) {
    EXPECT_EQ(read(x).rounding.beyond, 0u) << x;
  }
  for (const char* x : {"nan", "inf"}) {
    const auto file = write("m.obj", std::string("v ") + x + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(read_triangles(file, Coordinates::any).rounding.beyond, 0u) << x;
  }
  for (const char* x : {"1000000.01", "0.1000000001", "3.14159265358979", "16777217", "1e-46", "123456.7891"}) {
    const MeshPairs mesh = read(x);
    EXPECT_EQ(mesh.rounding.beyond, 1u) << x;
    ASSERT_EQ(mesh.in_doubles.size(), 1u) << x;
    EXPECT_EQ(mesh.in_doubles[0][0].x, std::strtod(x, nullptr));
    EXPECT_EQ(mesh.in_doubles[0][1].x, 1.0);
  }
}

// The double nearest to each of these numbers is a float32, but the number itself is not.
TEST_F(MeshFile, CountsWhatDoublesRoundToo) {
  for (const char* x : {"0.50000000000000001", "0.49999999999999999999", "0x1.00000000000000001p-1"}) {
    const MeshPairs mesh = read_triangles(write("m.obj", std::string("v ") + x + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    EXPECT_EQ(mesh.rounding.rounded, 1u) << x;
    EXPECT_GT(mesh.rounding.most, 0) << x;
    EXPECT_EQ(mesh.rounding.beyond, 0u) << x;
  }
}

TEST_F(MeshFile, TwoMeshesPairAcrossOnly) {
  const std::string touching =
      "OFF\n3 1 0\n1 1 1\n2 1 1\n1 2 1\n3 0 1 2\n";  // its box touches the tetrahedron's box at one point
  const MeshPairs pairs = read_bodies({write("t.off", kTetrahedron), write("u.off", touching)});
  EXPECT_EQ(pairs.triangles.size(), 5u);
  EXPECT_EQ(pairs.candidates, (std::vector<Index>{{3, 4}}));

  const MeshPairs twice = read_bodies({write("t.off", kTetrahedron), write("v.off", kTetrahedron)});
  EXPECT_EQ(twice.size(), 16u);
  for (const auto& [first, second] : twice.candidates) EXPECT_TRUE(first < 4 && second >= 4);
}

TEST_F(MeshFile, CandidatesEqualABruteForceSearch) {
  std::mt19937 random(2012);
  // Coordinates in a small range make many boxes that only touch, and some degenerate triangles.
  const auto soup = [&random](std::size_t count, unsigned extent) {
    const auto coordinate = [&] { return static_cast<float>(random() % extent + random() % 3); };
    std::vector<Triangle> triangles(count);
    for (Triangle& t : triangles) {
      const Vec3<float> base{coordinate(), coordinate(), coordinate()};
      for (auto& v : t) v = base + Vec3<float>{float(random() % 3), float(random() % 3), float(random() % 3)};
    }
    return triangles;
  };
  const std::vector<Triangle> first = soup(400, 20), second = soup(300, 20);

  std::vector<Index> expected;
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    for (std::uint32_t j = i + 1; j < first.size(); ++j) {
      if (boxes_overlap(first[i], first[j])) expected.push_back({i, j});
    }
  }
  const auto file = write("first.off", off_of(first));
  EXPECT_EQ(read_bodies({file}).triangles, first);
  EXPECT_EQ(read_bodies({file}).candidates, expected);

  expected.clear();
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    for (std::uint32_t j = 0; j < second.size(); ++j) {
      if (boxes_overlap(first[i], second[j])) expected.push_back({i, static_cast<std::uint32_t>(first.size()) + j});
    }
  }
  EXPECT_EQ(read_bodies({file, write("second.off", off_of(second))}).candidates, expected);
}

TEST_F(MeshFile, AFaceOfFiveVerticesBecomesAFan) {
  const std::string pentagon = "OFF\n5 1 0\n0 0 0\n2 0 0\n3 1 0\n2 2 0\n0 2 0\n5 0 1 2 3 4\n";
  const MeshPairs pairs = read_bodies({write("pentagon.off", pentagon)});
  ASSERT_EQ(pairs.triangles.size(), 3u);
  EXPECT_EQ(pairs.triangles[2], (Triangle{{{0, 0, 0}, {2, 2, 0}, {0, 2, 0}}}));
  EXPECT_EQ(pairs.size(), 3u);
}

TEST_F(MeshFile, RoundsToFloat32AndKeepsWhatDegenerates) {
  const std::string thin = "OFF\n4 2 0\n0.1 0 0\n1 0 0\n1.00000000001 0 0\n0 1 0\n3 0 1 2\n3 0 1 3\n";
  const MeshPairs pairs = read_bodies({write("thin.off", thin)});
  EXPECT_EQ(pairs.triangles[0], (Triangle{{{0.1f, 0, 0}, {1, 0, 0}, {1, 0, 0}}}));
  EXPECT_EQ(pairs.size(), 1u);
}

TEST_F(MeshFile, TheHashIsOfTheBytes) {
  const auto t = write("t.off", kTetrahedron), u = write("u.off", kTetrahedron + "\n");
  EXPECT_EQ(read_bodies({t}).content_hash, read_bodies({write("copy.off", kTetrahedron)}).content_hash);
  EXPECT_NE(read_bodies({t}).content_hash, read_bodies({u}).content_hash);
  EXPECT_NE(read_bodies({t, u}).content_hash, read_bodies({u, t}).content_hash);

  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : kTetrahedron) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  EXPECT_EQ(read_bodies({t}).content_hash, hash);
}

TEST_F(MeshFile, ErrorsNameTheFileAndSayWhy) {
  EXPECT_TRUE(names(error_of("missing.off"), {"missing.off", "No such file or directory"}));
  EXPECT_TRUE(names(error_of("."), {".", "Is a directory"}));
  write("mesh", "x");
  write("mesh.txt", "x");
  EXPECT_TRUE(names(error_of("mesh"), {"mesh", ".off", ".obj", ".stl", ".ply", "no extension"}));
  EXPECT_TRUE(names(error_of("mesh.txt"), {"mesh.txt", ".off", ".obj", ".stl", ".ply", ".txt"}));

  write("one.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_TRUE(names(error_of("one.off"), {"one.off", "boxes"}));
  write("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
  EXPECT_TRUE(names(error_of("points.off"), {"points.off", "no triangle"}));
  write("huge.off", "OFF\n3 1 0\n0 0 0\n1e39 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_TRUE(names(error_of("huge.off"), {"huge.off:4", "finite", "\"1e39\""}));
  write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  EXPECT_TRUE(names(error_of("index.obj"), {"index.obj:4", "3 vertices", "vertex 4"}));
}

// Content that is not used is always reported.
TEST_F(MeshFile, SaysWhatItDoesNotUse) {
  EXPECT_TRUE(read_bodies({write("t.off", kTetrahedron)}).notes.empty());
  const auto file = write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nl 1 2\nvn 0 0 1\nl 3 4\nf 1 2 3\nf 1 2 4\n");
  EXPECT_EQ(read_bodies({file}).notes,
            (std::vector<std::string>{file.string() + ": 2 triangles; not used: 2 lines, 1 normals"}));
}

// A fan from the first vertex covers a concave face exactly only if all other vertices are visible from it.
TEST_F(MeshFile, SaysWhereAFanFoldsOver) {
  const std::string quad = "OFF\n4 1 0\n0 4 0\n0 0 0\n4 0 0\n1 1 0\n4 ";
  const auto folded = write("folded.off", quad + "0 1 2 3\n");
  ASSERT_EQ(read_bodies({folded}).notes.size(), 1u);
  EXPECT_TRUE(names(read_bodies({folded}).notes[0], {"folded.off", "1 of 1 faces", "not convex"}));
  EXPECT_EQ(read_bodies({folded}).notes, read_bodies({folded}).notes_of_doubles);
  EXPECT_TRUE(read_bodies({write("covered.off", quad + "1 2 3 0\n")}).notes.empty());
  const char* obj = "v 0 4 0\nv 0 0 0\nv 4 0 0\nv 1 1 0\nv 3 3 1\nf 1 2 3 4\nf 1 2 3\nf 1 2 3 5\n";
  EXPECT_TRUE(names(read_bodies({write("two.obj", obj)}).notes.at(0), {"two.obj", "1 of 2 faces"}));
}

// In float32 the number nearest to 1000000.01 is 1000000, so it moves by 0.01; 0.5 does not move.
TEST_F(MeshFile, SaysWhatFloat32Rounds) {
  const std::string note = ": float32 rounded 2 of 12 coordinates, by at most 0.011";
  const char* off = "OFF\n4 2 0\n1000000.01 0 0.5\n1 0 0\n0 1000000.01 0\n0 0 1\n3 0 1 2\n3 0 1 3\n";
  const char* obj = "v 1000000.01 0 0.5\nv 1 0 0\nv 0 1000000.01 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n";
  const char* ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "1000000.01 0 0.5\n1 0 0\n0 1000000.01 0\n0 0 1\n3 0 1 2\n3 0 1 3\n";
  for (const auto& [name, text] : {std::pair{"r.off", off}, {"r.obj", obj}, {"r.ply", ply}}) {
    const auto file = write(name, text);
    const MeshPairs mesh = read_bodies({file});
    EXPECT_EQ(mesh.notes, std::vector{file.string() + note});
    EXPECT_EQ(mesh.rounding.rounded, 2u);
    EXPECT_GE(mesh.rounding.most, 0.0099999);
    EXPECT_LE(mesh.rounding.most, 0.0100001);
  }
  const auto file = write("t.off", kTetrahedron);
  EXPECT_EQ(read_bodies({file}, write("poses.csv", "1 0 0 1000000.01 0 1 0 0 0 0 1 0\n")).rounding.rounded, 12u);
  EXPECT_EQ(read_bodies({file}, write("whole.csv", "1 0 0 1000000 0 1 0 0 0 0 1 0\n")).rounding.rounded, 0u);
}

TEST(IsExactly, TellsWhatADoubleHides) {
  for (const char* text : {"0.5", "-0.5", "5e-1", "+00.50000", "0.5000000000000000000000000", "0x1p-1", "0x.8",
                           "500e-3", "0x0.80000000000000000000p0"})
    EXPECT_TRUE(is_exactly(text, text[0] == '-' ? -0.5 : 0.5)) << text;
  for (const char* text : {"0.50000000000000001", "0.49999999999999999999", "0.5000000000000000000000001",
                           "0x1.00000000000000001p-1", "0x0.800000000000000001"})
    EXPECT_FALSE(is_exactly(text, 0.5)) << text;
  EXPECT_TRUE(is_exactly("0.100000001490116119384765625", 0.1f));
  EXPECT_FALSE(is_exactly("0.1000000014901161193847656", 0.1f));
  EXPECT_TRUE(is_exactly("0", 0));
  EXPECT_TRUE(is_exactly("-0.000e5", -0.0));
  EXPECT_FALSE(is_exactly("1e-400", 0));
  EXPECT_TRUE(is_exactly("0x1p-1074", 0x1p-1074));
  EXPECT_FALSE(is_exactly("4.9e-324", 0x1p-1074));
  EXPECT_TRUE(is_exactly("16777216", 0x1p24));
  EXPECT_TRUE(is_exactly("1e22", 1e22));
  EXPECT_FALSE(is_exactly("1e23", 1e23));
}

// No coordinate moves farther from the file's decimal or binary double than the note states.
TEST_F(MeshFile, BoundsHowFarFloat32Moves) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
        "property double z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
    std::string text = "OFF\n3 2 0\n";
    double numbers[9];
    std::uint64_t moved = 0, moved_in_text = 0;  // a decimal of 17 digits identifies a double, but rarely equals it
    double most = 0;
    for (double& x : numbers) {
      x = std::ldexp(static_cast<double>(static_cast<std::int64_t>(random())), static_cast<int>(random() % 100) - 113);
      if (random() % 4 == 0) x = static_cast<double>(static_cast<float>(x));
    }
    for (std::size_t i = 0; i < 9; ++i) {
      char word[40];
      std::snprintf(word, sizeof word, "%.17g", numbers[i]);
      (text += word) += i % 3 == 2 ? '\n' : ' ';
      const double by = std::abs(numbers[i] - static_cast<double>(static_cast<float>(numbers[i])));
      moved += by > 0;
      moved_in_text += by > 0 || !is_exactly(word, numbers[i]);
      most = std::max(most, by);
      header.append(reinterpret_cast<const char*>(&numbers[i]), 8);
    }
    text += "3 0 1 2\n3 0 1 2\n";
    for (int face = 0; face < 2; ++face) header.append("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
    for (const auto& [file, slack] : {std::pair{write("d.off", text), 1e-9}, {write("d.ply", header), 0.0}}) {
      const Rounding& rounding = read_triangles(file).rounding;
      EXPECT_EQ(rounding.rounded, slack > 0 ? moved_in_text : moved);
      EXPECT_EQ(rounding.coordinates, 9u);
      EXPECT_GE(rounding.most, most);
      EXPECT_LE(rounding.most, most * (1 + slack) + (slack > 0 ? most * 1e-6 : 0));
    }
  }
}

TEST(MeshFormats, AreThoseOfTheTable) {
  EXPECT_EQ(mesh_formats(), "OFF, OBJ, STL or PLY");
  for (const char* file : {"a.off", "b/A.PLY", "a.b.stl"}) EXPECT_TRUE(is_mesh(file)) << file;
  for (const char* file : {"off", "a.pairs", "a.off.gz", ""}) EXPECT_FALSE(is_mesh(file)) << file;
}

}  // namespace
}  // namespace graze::strata
