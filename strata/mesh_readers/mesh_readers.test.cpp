// SPDX-License-Identifier: Apache-2.0
// The readers of mesh files are strict: what they take is what stands there, and everything else is an error that
// names its place. A damaged file never becomes another mesh.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <stdexcept>

#include "strata/mesh_readers/soup.h"

namespace graze::strata {
namespace {

using Reader = Soup (*)(const MeshBytes&);
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Skipped = std::map<std::string, std::uint64_t>;

std::string error_of(Reader read, const std::string& bytes) {
  try {
    const Soup soup = read({"m", bytes});
    return "read " + std::to_string(soup.triangles.size()) + " triangles";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

struct Misfit {
  std::string bytes, error;
};

void expect_errors(Reader read, const std::vector<Misfit>& misfits) {
  for (const Misfit& misfit : misfits) EXPECT_EQ(error_of(read, misfit.bytes), misfit.error) << misfit.bytes;
}

const std::string kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";

TEST(ReadOff, TakesItsVariantsAndCountsWhatItSkips) {
  EXPECT_EQ(read_off({"m", kOff + "3 0 1 2\n"}).triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(read_off({"m", "\xef\xbb\xbfOFF 3 1 0 # counts\r\n\r\n0\t0 0\r\n1 0 0 # v\r\n0 1 0\r\n 3 0 1 2"})
                .triangles.size(),
            1u);
  EXPECT_EQ(read_off({"m", "3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}).triangles.size(), 1u);
  const Soup coloured = read_off({"m",
                                  "CNOFF\n3 2 0\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 255 0 0\n0 1 0 0 0 1 1 0 0 .5\n"
                                  "3 0 1 2 9\n2 0 1 1 0 0\n"});
  EXPECT_EQ(coloured.triangles.size(), 1u);
  EXPECT_EQ(coloured.skipped, (Skipped{{"normals", 3},
                                       {"colours of vertices", 3},
                                       {"colours of faces", 2},
                                       {"faces of fewer than three vertices", 1}}));
}

TEST(ReadOff, RoundsDecimalsOnce) {
  // A tie of float32 but for its last digit, which a double cannot hold.
  const Soup soup = read_off({"m", "OFF\n3 1 0\n16777217.0000000001 0 0\n0.1 0 0\n-0 1e-46 7.1e-46\n3 0 1 2\n"});
  EXPECT_EQ(soup.vertices[0].x, 16777218.0f);
  EXPECT_EQ(soup.vertices[1].x, 0.1f);
  EXPECT_TRUE(std::signbit(soup.vertices[2].x));
  EXPECT_EQ(soup.vertices[2].z, 0x1p-149f);
}

TEST(ReadOff, NamesLineExpectedAndFound) {
  expect_errors(
      read_off,
      {{"", "m:0: expected OFF, found the end of the file"},
       {"solid x\n", "m:1: expected OFF, or COFF, NOFF, CNOFF, STOFF, found \"solid\""},
       {"4OFF\n", "m:1: expected OFF, or COFF, NOFF, CNOFF, STOFF, found \"4OFF\""},
       {"OFF BINARY\n", "m:1: expected OFF in text, found \"BINARY\""},
       {"OFF\n-3 1 0\n", "m:2: expected the number of vertices, found \"-3\""},
       {"OFF\n3 1.0 0\n", "m:2: expected the number of faces, found \"1.0\""},
       {"OFF\n4000000000 1 0\n0 0 0\n",
        "m:2: expected at most 1 vertices and 3 faces in the 6 bytes that follow, found 4000000000 and 1"},
       {"OFF\n99999999999999999999 1 0\n", "m:2: expected the number of vertices, found \"99999999999999999999\""},
       {kOff + "3 0 1 99999999999999999999\n", "m:6: expected a vertex from 0 to 2, found \"99999999999999999999\""},
       {kOff + "3 0 1 4294967297\n", "m:6: expected a vertex from 0 to 2, found \"4294967297\""},
       {kOff + "3 0.5 1 2\n", "m:6: expected a vertex from 0 to 2, found \"0.5\""},
       {kOff + "3 0 1 -1\n", "m:6: expected a vertex from 0 to 2, found \"-1\""},
       {kOff + "3 0 1 3\n", "m:6: expected a vertex from 0 to 2, found \"3\""},
       {kOff + "3 0 1\n", "m:6: expected 3 vertices of a face, found 2 numbers"},
       {kOff + "18446744073709551615 0 1\n", "m:6: expected 18446744073709551615 vertices of a face, found 2 numbers"},
       {kOff + "3 0 1 2 0 0\n", "m:6: expected 3 vertices of a face, and at most a colour, found 5 numbers"},
       {kOff + "3 0 1 2 red\n", "m:6: expected a number or the end of the line, found \"red\""},
       {kOff, "m:5: expected 1 faces, found the end of the file"},
       {kOff + "3 0 1 2\n3 0 1 2\n", "m:7: expected the end of the file after 3 vertices and 1 faces, found \"3\""},
       {"OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n",
        "m:4: expected a coordinate that is finite in float32, found \"x\""},
       {"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
        "m:4: expected a coordinate that is finite in float32, found \"nan\""},
       {"OFF\n3 1 0\n0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n",
        "m:4: expected a coordinate that is finite in float32, found \"1e39\""},
       {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
        "m:4: expected a coordinate that is finite in float32, found the end of the line"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n", "m:4: expected three coordinates, found 4 numbers"},
       {"NOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "m:3: expected three coordinates and what the header announces, found 3 numbers"}});
}

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(ReadObj, TakesEveryNotationOfAFace) {
  const Soup soup =
      read_obj({"m",
                "mtllib a b.mtl\no thing\n\tv\t0 0 0 # first\r\nv 1 0 0 1\nv 0 1 0 .5 .5 .5\nv 1 1 0\n"
                "vt 0 0\nvn 0 0 1\ng\ns off\nusemtl red\nl 1 2\nl 2 3 4\np 1\n"
                "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 \\\n 3/1/1\nf -4 -3 -2 -1\nf 5 1 2\n"
                "v 2 2 2\n"});
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {4, 0, 1}}));
  EXPECT_EQ(soup.skipped, (Skipped{{"material libraries", 1},
                                   {"objects", 1},
                                   {"weights", 1},
                                   {"colours of vertices", 1},
                                   {"texture coordinates", 1},
                                   {"normals", 1},
                                   {"groups", 1},
                                   {"smoothing groups", 1},
                                   {"materials", 1},
                                   {"lines", 2},
                                   {"points", 1}}));
}

TEST(ReadObj, NamesLineExpectedAndFound) {
  const std::string corner = "a vertex as 1, 1/2, 1//3 or 1/2/3, or one of the last 3 as -1, found ";
  expect_errors(
      read_obj,
      {{kObj + "f 1 3 x\n", "m:4: expected " + corner + "\"x\""},
       {kObj + "f 1 2\n", "m:4: expected a face of three vertices or more, found 2"},
       {kObj + "f\n", "m:4: expected a face of three vertices or more, found 0"},
       {kObj + "f 1 2 4294967297\n", "m:4: expected " + corner + "\"4294967297\""},
       {kObj + "f 1 2 0\n", "m:4: expected " + corner + "\"0\""},
       {kObj + "f 1 2 -4\n", "m:4: expected " + corner + "\"-4\""},
       {kObj + "f 1 2 3.0\n", "m:4: expected " + corner + "\"3.0\""},
       {kObj + "f 1 2 3/\n", "m:4: expected " + corner + "\"3/\""},
       {kObj + "f 1 2 3//\n", "m:4: expected " + corner + "\"3//\""},
       {kObj + "f 1 2 3/1/1/1\n", "m:4: expected " + corner + "\"3/1/1/1\""},
       {kObj + "f 1 2 4\nf 1 2 3\n", "m:4: expected faces of the file's 3 vertices, found vertex 4"},
       {kObj + "v 1 2\n", "m:4: expected a coordinate that is finite in float32, found the end of the line"},
       {kObj + "v 1 2 3 4 5\n", "m:4: expected three coordinates, a weight or a colour, found 5 numbers"},
       {kObj + "vector 1 2\n", "m:4: expected v, f, vt, vn, l, p, g, o, s, usemtl or mtllib, found \"vector\""},
       {kObj + "\x1b[2J\n", "m:4: expected v, f, vt, vn, l, p, g, o, s, usemtl or mtllib, found \"\\x1b[2J\""}});
}

const std::string kStl =
    "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

std::string binary_stl(std::uint32_t count, std::size_t bytes_of_facets, const char* header = "solid b") {
  std::string bytes(80, ' ');
  bytes.replace(0, std::strlen(header), header);
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  return bytes + std::string(bytes_of_facets, '\0');
}

TEST(ReadStl, TellsTextFromBinaryByItsSize) {
  EXPECT_EQ(read_stl({"m", kStl + "endsolid a b\n" + kStl + "endsolid\n"}).triangles.size(), 2u);
  std::string bytes = binary_stl(2, 100);
  bytes[84 + 48] = 7;
  const Soup soup = read_stl({"m", bytes});
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(soup.skipped, (Skipped{{"normals", 2}, {"attributes of facets", 1}}));
}

TEST(ReadStl, NamesPlaceExpectedAndFound) {
  std::string not_finite = binary_stl(1, 50);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&not_finite[84 + 16], &nan, sizeof nan);
  std::string broken = kStl;
  broken.replace(broken.find("vertex 1"), 8, "vertex x");
  expect_errors(
      read_stl,
      {{"garbage",
        "m:1: expected solid, or a binary file of 84 bytes and 50 for each facet that they count, found \"garbage\""},
       {kStl, "m:8: expected endsolid, found the end of the file"},
       {broken, "m:5: expected a coordinate that is finite in float32, found \"x\""},
       {"solid\nfacet normal 0 0\n", "m:2: expected three numbers of a normal, found the end of the line"},
       {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
        "m:6: expected vertex and three numbers, found \"endloop\""},
       {"solid\nvertex 0 0 0\n", "m:2: expected facet or endsolid, found \"vertex\""},
       {binary_stl(2, 99), "m: byte 80: expected 2 facets, for which the file has 184 bytes, found 183 bytes"},
       {binary_stl(4294967295u, 50),
        "m: byte 80: expected 4294967295 facets, for which the file has 214748364834 bytes, found 134 bytes"},
       {not_finite, "m: byte 84: expected a facet with finite coordinates, found one without"}});
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "property list uchar int vertex_indices\n";

std::string ply_header(const std::string& format, const std::string& vertices, const std::string& faces) {
  return "ply\nformat " + format + " 1.0\ncomment c\nelement vertex " + vertices + "\n" + kXyz + "element face " +
         faces + "\n" + kFace + "end_header\n";
}

// Three vertices and one face, in that byte order.
std::string ply_body(bool big) {
  std::string body;
  const auto append = [&](auto value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    body += big ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
  };
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(x);
  append(std::uint8_t{3});
  for (const std::int32_t i : {0, 1, 2}) append(i);
  return body;
}

TEST(ReadPly, TakesTextAndBothByteOrders) {
  const std::string text = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string& bytes :
       {ply_header("ascii", "3", "1") + text, ply_header("binary_little_endian", "3", "1") + ply_body(false),
        ply_header("binary_big_endian", "3", "1") + ply_body(true)}) {
    const Soup soup = read_ply({"m", bytes});
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
    EXPECT_EQ(soup.vertices[1].x, 1.0f);
    EXPECT_TRUE(soup.skipped.empty());
  }
  const Soup soup = read_ply(
      {"m",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty uchar red\nproperty double z\nproperty "
       "double y\nproperty double x\nelement edge 2\nproperty int a\nproperty list uchar float b\nelement face "
       "2\nproperty list uint8 uint vertex_index\nproperty list int int t\nend_header\n9 0 0 0\n9 0 0 1\n9 0 1 0\n1 "
       "0\n2 1 "
       "5\n3 0 1 2 1 7\n2 0 1 0\n"});
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(soup.vertices[1].x, 1.0f);
  EXPECT_EQ(soup.skipped, (Skipped{{"elements edge", 2},
                                   {"faces of fewer than three vertices", 1},
                                   {"values of vertex.red", 3},
                                   {"values of face.t", 2}}));
}

TEST(ReadPly, NamesPlaceExpectedAndFound) {
  const std::string little = ply_header("binary_little_endian", "3", "1"), body = ply_body(false);
  const std::string at = "m: byte " + std::to_string(little.size());
  std::string negative_list = body, far = body, not_finite = body;
  negative_list[36] = '\xff';
  far[37] = 3;
  not_finite.replace(4, 4, std::string("\0\0\xc0\x7f", 4));
  expect_errors(
      read_ply,
      {{"", "m:0: expected ply, found the end of the file"},
       {"ply\nformat ascii 2.0\n",
        "m:2: expected ascii, binary_little_endian or binary_big_endian, and 1.0, found \"ascii\""},
       {"ply\nformat ascii 1.0\nproperty float x\n",
        "m:3: expected an element before its properties, found a property"},
       {"ply\nformat ascii 1.0\nelement vertex -1\n", "m:3: expected a count of elements, found \"-1\""},
       {"ply\nformat ascii 1.0\nelement vertex 3\nproperty int x\n",
        "m:4: expected float or double as the type of a coordinate, found \"int\""},
       {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nend_header\n",
        "m:6: expected coordinates x, y and z of the element vertex, found none"},
       {"ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\n",
        "m:4: expected an integer type, found \"float\""},
       {ply_header("ascii", "4294967295", "1") + "0 0 0\n",
        "m:10: expected at most 1 elements vertex in the 7 bytes that are left, found 4294967295"},
       {ply_header("binary_little_endian", "4294967295", "1") + body,
        at.substr(0, 8) + std::to_string(little.size() + 9) +
            ": expected at most 4 elements vertex in the 49 bytes that are left, found 4294967295"},
       {ply_header("binary_little_endian", "3", "4294967295") + body,
        at.substr(0, 8) + std::to_string(little.size() + 9 + 36) +
            ": expected at most 13 elements face in the 13 bytes that are left, found 4294967295"},
       {ply_header("binary_little_endian", "-3", "1") + body, "m:4: expected a count of elements, found \"-3\""},
       {little + negative_list,
        "m: byte " + std::to_string(little.size() + 37) + ": expected at most 3 numbers of vertex_indices, found 255"},
       {little + far, "m: byte " + std::to_string(little.size() + 41) + ": expected a vertex below 3, found 3"},
       {little + not_finite, "m: byte " + std::to_string(little.size() + 8) +
                                 ": expected a coordinate that is finite in float32, found one that is not"},
       {little + body + '\n', "m: byte " + std::to_string(little.size() + 49) +
                                  ": expected the end of the file after its elements, found 1 bytes more"},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 3\n",
        "m:14: expected the end of the line, found \"3\""},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
        "m:14: expected at most 2 numbers of vertex_indices, found 3"},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 0.5\n",
        "m:14: expected a vertex below 3, found \"0.5\""},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
        "m:15: expected the end of the file after its elements, found \"3\""}});
}

// Whatever the damage: an error of one line, or triangles of vertices that exist.
TEST(MeshReaders, DamagedFilesNeverCrash) {
  const std::vector<std::pair<Reader, std::string>> files = {
      {read_off, kOff + "3 0 1 2\n"},
      {read_obj, kObj + "f 1/1 2/2 3/3\nf -1 -2 -3\n"},
      {read_stl, kStl + "endsolid\n"},
      {read_stl, binary_stl(2, 100)},
      {read_ply, ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {read_ply, ply_header("binary_little_endian", "3", "1") + ply_body(false)},
      {read_ply, ply_header("binary_big_endian", "3", "1") + ply_body(true)}};
  std::mt19937 random(13);
  int errors = 0;
  for (int round = 0; round < 20000; ++round) {
    auto [read, bytes] = files[static_cast<std::size_t>(round) % files.size()];
    for (auto changes = 1 + random() % 3; changes > 0; --changes) {
      const std::size_t at = random() % bytes.size();
      const auto kind = random() % 4;
      if (kind == 0) bytes[at] = static_cast<char>(random());
      if (kind == 1) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
      if (kind == 2) bytes.erase(at, random() % 5);
      if (kind == 3) bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 9));
      if (bytes.empty()) bytes = " ";
    }
    try {
      const Soup soup = read({"m", bytes});
      for (const auto& triangle : soup.triangles) {
        for (const std::uint32_t v : triangle) ASSERT_LT(v, soup.vertices.size());
      }
    } catch (const std::runtime_error& error) {
      ++errors;
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(errors, 10000);
}

}  // namespace
}  // namespace graze::strata
