// SPDX-License-Identifier: Apache-2.0
// Tests that the mesh readers are strict: they read a file exactly, or give an error that names the place. A damaged
// file is never read as a different mesh.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <stdexcept>

#include "core/message_testing.h"
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
  std::string bytes;
  std::vector<std::string> named;  // words in the error: the place, what was expected, what was found
};

void expect_errors(Reader read, const std::vector<Misfit>& misfits) {
  for (const Misfit& misfit : misfits) EXPECT_TRUE(names(error_of(read, misfit.bytes), misfit.named)) << misfit.bytes;
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
  EXPECT_EQ(
      coloured.skipped,
      (Skipped{
          {"normals", 3}, {"vertex colours", 3}, {"face colours", 2}, {"faces with fewer than three vertices", 1}}));
}

TEST(ReadOff, RoundsDecimalsOnce) {
  // A double cannot hold the first number's last digit, without which it is a tie between two float32 numbers.
  const Soup soup = read_off({"m", "OFF\n3 1 0\n16777217.0000000001 0 0\n0.1 0 0\n-0 1e-46 7.1e-46\n3 0 1 2\n"});
  EXPECT_EQ(soup.vertices[0].x, 16777218.0f);
  EXPECT_EQ(soup.vertices[1].x, 0.1f);
  EXPECT_TRUE(std::signbit(soup.vertices[2].x));
  EXPECT_EQ(soup.vertices[2].z, 0x1p-149f);
}

TEST(ReadOff, NamesLineExpectedAndFound) {
  expect_errors(read_off,
                {{"", {"m:0", "OFF", "end"}},
                 {"solid x\n", {"m:1", "OFF", "COFF", "STOFF", "solid"}},
                 {"4OFF\n", {"m:1", "OFF", "COFF", "STOFF", "4OFF"}},
                 {"OFF BINARY\n", {"m:1", "OFF", "BINARY"}},
                 {"OFF\n-3 1 0\n", {"m:2", "vertices", "-3"}},
                 {"OFF\n3 1.0 0\n", {"m:2", "faces", "1.0"}},
                 {"OFF\n4000000000 1 0\n0 0 0\n", {"m:2", "1", "vertices", "3", "faces", "6", "4000000000"}},
                 {"OFF\n99999999999999999999 1 0\n", {"m:2", "vertices", "99999999999999999999"}},
                 {kOff + "3 0 1 99999999999999999999\n", {"m:6", "vertex", "0", "2", "99999999999999999999"}},
                 {kOff + "3 0 1 4294967297\n", {"m:6", "vertex", "0", "2", "4294967297"}},
                 {kOff + "3 0.5 1 2\n", {"m:6", "vertex", "0", "2", "0.5"}},
                 {kOff + "3 0 1 -1\n", {"m:6", "vertex", "0", "2", "-1"}},
                 {kOff + "3 0 1 3\n", {"m:6", "vertex", "0", "2", "3"}},
                 {kOff + "3 0 1\n", {"m:6", "3", "vertices", "face", "2"}},
                 {kOff + "18446744073709551615 0 1\n", {"m:6", "18446744073709551615", "vertices", "face", "2"}},
                 {kOff + "3 0 1 2 0 0\n", {"m:6", "3", "vertices", "face", "colour", "5"}},
                 {kOff + "3 0 1 2 red\n", {"m:6", "end", "red"}},
                 {kOff, {"m:5", "1", "faces", "end"}},
                 {kOff + "3 0 1 2\n3 0 1 2\n", {"m:7", "end", "3", "vertices", "1", "faces"}},
                 {"OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", {"m:4", "coordinate", "finite", "float32", "x"}},
                 {"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", {"m:4", "coordinate", "finite", "float32", "nan"}},
                 {"OFF\n3 1 0\n0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n", {"m:4", "coordinate", "finite", "float32", "1e39"}},
                 {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", {"m:4", "coordinate", "finite", "float32", "end"}},
                 {"OFF\n3 1 0\n0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n", {"m:4", "coordinates", "4"}},
                 {"NOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {"m:3", "coordinates", "3"}}});
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
                                   {"vertex colours", 1},
                                   {"texture coordinates", 1},
                                   {"normals", 1},
                                   {"groups", 1},
                                   {"smoothing groups", 1},
                                   {"materials", 1},
                                   {"lines", 2},
                                   {"points", 1}}));
}

TEST(ReadObj, NamesLineExpectedAndFound) {
  expect_errors(read_obj, {{kObj + "f 1 3 x\n", {"m:4", "vertex", "-1", "x"}},
                           {kObj + "f 1 2\n", {"m:4", "face", "vertices", "2"}},
                           {kObj + "f\n", {"m:4", "face", "vertices", "0"}},
                           {kObj + "f 1 2 4294967297\n", {"m:4", "vertex", "-1", "4294967297"}},
                           {kObj + "f 1 2 0\n", {"m:4", "vertex", "-1", "0"}},
                           {kObj + "f 1 2 -4\n", {"m:4", "vertex", "-1", "-4"}},
                           {kObj + "f 1 2 3.0\n", {"m:4", "vertex", "-1", "3.0"}},
                           {kObj + "f 1 2 3/\n", {"m:4", "vertex", "-1", "3/"}},
                           {kObj + "f 1 2 3//\n", {"m:4", "vertex", "-1", "3//"}},
                           {kObj + "f 1 2 3/1/1/1\n", {"m:4", "vertex", "-1", "3/1/1/1"}},
                           {kObj + "f 1 2 4\nf 1 2 3\n", {"m:4", "faces", "3", "vertices", "vertex", "4"}},
                           {kObj + "v 1 2\n", {"m:4", "coordinate", "finite", "float32", "end"}},
                           {kObj + "v 1 2 3 4 5\n", {"m:4", "coordinates", "colour", "5"}},
                           {kObj + "vector 1 2\n", {"m:4", "v", "f", "usemtl", "vector"}},
                           {kObj + "\x1b[2J\n", {"m:4", "v", "f", "usemtl", "\\x1b[2J"}}});
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
  EXPECT_EQ(soup.skipped, (Skipped{{"normals", 2}, {"facet attributes", 1}}));
}

TEST(ReadStl, NamesPlaceExpectedAndFound) {
  std::string not_finite = binary_stl(1, 50);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&not_finite[84 + 16], &nan, sizeof nan);
  std::string broken = kStl;
  broken.replace(broken.find("vertex 1"), 8, "vertex x");
  expect_errors(read_stl, {{"garbage", {"m:1", "solid", "84", "50", "facet", "garbage"}},
                           {kStl, {"m:8", "endsolid", "end"}},
                           {broken, {"m:5", "coordinate", "finite", "float32", "x"}},
                           {"solid\nfacet normal 0 0\n", {"m:2", "normal", "end"}},
                           {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
                            {"m:6", "vertex", "endloop"}},
                           {"solid\nvertex 0 0 0\n", {"m:2", "facet", "endsolid", "vertex"}},
                           {binary_stl(2, 99), {"byte 80", "2", "facets", "184", "183"}},
                           {binary_stl(4294967295u, 50), {"byte 80", "4294967295", "facets", "214748364834", "134"}},
                           {not_finite, {"byte 84", "facet", "finite", "coordinates"}}});
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "property list uchar int vertex_indices\n";

std::string ply_header(const std::string& format, const std::string& vertices, const std::string& faces) {
  return "ply\nformat " + format + " 1.0\ncomment c\nelement vertex " + vertices + "\n" + kXyz + "element face " +
         faces + "\n" + kFace + "end_header\n";
}

// Three vertices and one face, in the given byte order.
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
  EXPECT_EQ(soup.skipped, (Skipped{{"elements named edge", 2},
                                   {"faces with fewer than three vertices", 1},
                                   {"values of vertex.red", 3},
                                   {"values of face.t", 2}}));
}

TEST(ReadPly, NamesPlaceExpectedAndFound) {
  const std::string little = ply_header("binary_little_endian", "3", "1"), body = ply_body(false);
  std::string negative_list = body, far = body, not_finite = body;
  negative_list[36] = '\xff';
  far[37] = 3;
  not_finite.replace(4, 4, std::string("\0\0\xc0\x7f", 4));
  expect_errors(
      read_ply,
      {{"", {"m:0", "ply", "end"}},
       {"ply\nformat ascii 2.0\n", {"m:2", "ascii", "binary_little_endian", "1.0"}},
       {"ply\nformat ascii 1.0\nproperty float x\n", {"m:3", "element", "properties", "property"}},
       {"ply\nformat ascii 1.0\nelement vertex -1\n", {"m:3", "elements", "-1"}},
       {"ply\nformat ascii 1.0\nelement vertex 3\nproperty int x\n", {"m:4", "float", "double", "coordinate", "int"}},
       {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nend_header\n",
        {"m:6", "coordinates", "x", "y", "z", "element", "vertex"}},
       {"ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\n", {"m:4", "integer", "float"}},
       {ply_header("ascii", "4294967295", "1") + "0 0 0\n", {"m:10", "1", "elements", "vertex", "7", "4294967295"}},
       {ply_header("binary_little_endian", "4294967295", "1") + body,
        {"byte " + std::to_string(little.size() + 9), "4", "elements", "vertex", "49", "4294967295"}},
       {ply_header("binary_little_endian", "3", "4294967295") + body,
        {"byte " + std::to_string(little.size() + 9 + 36), "13", "elements", "face", "4294967295"}},
       {ply_header("binary_little_endian", "-3", "1") + body, {"m:4", "elements", "-3"}},
       {little + negative_list, {"byte " + std::to_string(little.size() + 37), "3", "vertex_indices", "255"}},
       {little + far, {"byte " + std::to_string(little.size() + 41), "vertex", "3"}},
       {little + not_finite, {"byte " + std::to_string(little.size() + 8), "coordinate", "finite", "float32"}},
       {little + body + '\n', {"byte " + std::to_string(little.size() + 49), "end", "elements", "1"}},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 3\n", {"m:14", "end", "3"}},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", {"m:14", "2", "vertex_indices", "3"}},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 0.5\n", {"m:14", "vertex", "3", "0.5"}},
       {ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", {"m:15", "end", "elements", "3"}}});
}

// A damaged file gives a one-line error, or triangles whose vertices exist.
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
