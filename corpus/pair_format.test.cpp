// SPDX-License-Identifier: Apache-2.0
// The text format: what is written reads back bit for bit, decimals round once, and every misfit has its message.
#include "corpus/pair_format.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "core/text.h"

namespace graze::corpus {
namespace {

constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::uint32_t bits(float value) {
  std::uint32_t result;
  std::memcpy(&result, &value, sizeof result);
  return result;
}

std::string write(const Entry& entry) {
  std::ostringstream out;
  write_header(out);
  write_entry(out, entry);
  return out.str();
}

std::vector<Entry> read(const std::string& text) {
  std::istringstream in(text);
  PairReader reader(in, "in.pairs");
  std::vector<Entry> entries;
  while (auto entry = reader.next()) entries.push_back(*entry);
  return entries;
}

std::string error_of(const std::string& text) {
  try {
    return "read " + std::to_string(read(text).size()) + " entries";
  } catch (const FormatError& error) {
    return error.what();
  }
}

const std::string kZeros = "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0";  // 18 numbers
const std::string kSeventeen = "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0";

TEST(HexFloat, IsShortestAndKeepsSigns) {
  EXPECT_EQ(hex_float(3.0f), "0x1.8p+1");
  EXPECT_EQ(hex_float(0.1f), "0x1.99999ap-4");
  EXPECT_EQ(hex_float(0.0f), "0x0p+0");
  EXPECT_EQ(hex_float(-0.0f), "-0x0p+0");
  EXPECT_EQ(hex_float(kSmallest), "0x1p-149");
  EXPECT_EQ(hex_float(-kMax), "-0x1.fffffep+127");
  EXPECT_EQ(hex_float(kInfinity), "inf");
  EXPECT_EQ(hex_float(-kInfinity), "-inf");
  EXPECT_EQ(hex_float(kNan), "nan");
}

TEST(HexFloat, EveryKindOfFloatReadsBack) {
  std::mt19937 random(20120604);
  for (int i = 0; i < 200000; ++i) {
    auto pattern = static_cast<std::uint32_t>(random());
    if (i % 4 == 0) pattern &= 0x807fffffu;  // subnormal
    float value;
    std::memcpy(&value, &pattern, sizeof value);
    const std::optional<float> back = parse_float32(hex_float(value));
    ASSERT_TRUE(back) << hex_float(value);
    if (std::isnan(value)) {
      ASSERT_TRUE(std::isnan(*back));
    } else {
      ASSERT_EQ(bits(*back), pattern) << hex_float(value);
    }
  }
}

TEST(NumbersOf, NeedsAllThree) {
  Entry entry{{}, {{"index", "42"}, {"stratum", "uniform"}}, 0};
  EXPECT_EQ(numbers_of(entry), std::nullopt);
  entry.fields.push_back({"seed", "1"});
  EXPECT_EQ(numbers_of(entry), "uniform:1:42");
}

TEST(PairFormat, AnEntryReadsBack) {
  Entry entry;
  const float values[kCoordinates] = {0, -0.0f, 1, 0.1f, kSmallest, -kSmallest, 1e-40f, kMax, -kMax,
                                      1, 2,     3, 4,    5,         6,          7,      8,    9};
  std::copy(std::begin(values), std::end(values), coordinates(entry.pair));
  entry.fields = {{"name", "all_kinds"},
                  {"source", "owner/repository#152"},
                  {"empty", ""},
                  {"note", "two words, a \"quote\", a \\ and a # and a |"},
                  {"bytes", std::string("\0\n\r\t\x7f\xff", 6)},
                  {"quote", "\"bare"}};
  const std::vector<Entry> back = read(write(entry));
  ASSERT_EQ(back.size(), 1u);
  for (int i = 0; i < kCoordinates; ++i) EXPECT_EQ(bits(coordinates(back[0].pair)[i]), bits(values[i])) << i;
  EXPECT_EQ(back[0].fields, entry.fields);
  EXPECT_EQ(back[0].line, 2u);
  EXPECT_EQ(write(back[0]), write(entry));
}

TEST(PairFormat, NonFiniteNumbersReadBack) {
  Entry entry;
  entry.pair.a[0] = {kInfinity, -kInfinity, kNan};
  const Vec3<float> back = read(write(entry)).at(0).pair.a[0];
  EXPECT_EQ(back.x, kInfinity);
  EXPECT_EQ(back.y, -kInfinity);
  EXPECT_TRUE(std::isnan(back.z));
}

TEST(PairFormat, WritesOneLineAnEntry) {
  Entry entry;
  entry.pair.b[2].z = -1.5f;
  entry.fields = {{"name", "x"}, {"note", "a b"}};
  std::string zeros;
  for (int i = 0; i < 17; ++i) zeros += "0x0p+0 ";
  EXPECT_EQ(write(entry), "graze-pairs 1\n" + zeros + "-0x1.8p+0 | name=x note=\"a b\"\n");
}

TEST(PairFormat, SkipsCommentsAndBlankLines) {
  const auto entries = read("# SPDX\n\n  # more\ngraze-pairs 1  # version\n \t\r\n" + kZeros + " # 1 | x=y\n" + kZeros +
                            "\t|name=a#b note=\"# inside\" # outside\r\n" + kZeros + "|");
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_TRUE(entries[0].fields.empty());
  EXPECT_EQ(entries[0].line, 6u);
  EXPECT_EQ(*field(entries[1], "name"), "a#b");
  EXPECT_EQ(*field(entries[1], "note"), "# inside");
  EXPECT_EQ(field(entries[1], "outside"), nullptr);
  EXPECT_EQ(entries[2].line, 8u);
}

TEST(PairFormat, TheVersionLineMayBeMissingOrRepeated) {
  EXPECT_EQ(read(kZeros).size(), 1u);
  EXPECT_EQ(read("graze-pairs 1\n" + kZeros + "\ngraze-pairs 1\n" + kZeros).size(), 2u);  // two files, concatenated
  EXPECT_EQ(read("").size(), 0u);
}

TEST(PairFormat, AForeignVersionIsNamed) {
  EXPECT_EQ(error_of("\ngraze-pairs 2\n"),
            R"(in.pairs:2: expected the version line "graze-pairs 1", found "graze-pairs 2")");
  EXPECT_EQ(error_of("graze-pairs\n"), R"(in.pairs:1: expected the version line "graze-pairs 1", found "graze-pairs")");
}

TEST(PairFormat, AWrongCountIsNamed) {
  EXPECT_EQ(error_of(kSeventeen), "in.pairs:1: expected 18 numbers, found 17");
  EXPECT_EQ(error_of("\n" + kSeventeen + " # 0"), "in.pairs:2: expected 18 numbers, found 17");
  EXPECT_EQ(error_of(kSeventeen + " | name=x"), "in.pairs:1: expected 18 numbers, found 17");
  EXPECT_EQ(error_of("| name=x"), "in.pairs:1: expected 18 numbers, found 0");
  EXPECT_EQ(error_of(kZeros + " 0 0"), "in.pairs:1: expected 18 numbers, found 20");
  EXPECT_EQ(error_of(kZeros + " name=x"),
            R"(in.pairs:1: expected '|' or the end of the line after 18 numbers, found "name=x")");
}

TEST(PairFormat, AWordThatIsNoFloat32IsNamed) {
  EXPECT_EQ(error_of("0 0 0 0 one 0"), R"(in.pairs:1: expected a float32 as number 5 (a[1].y), found "one")");
  EXPECT_EQ(error_of(kSeventeen + " 1e39"), R"(in.pairs:1: expected a float32 as number 18 (b[2].z), found "1e39")");
  EXPECT_EQ(error_of("0,one,0"), R"(in.pairs:1: expected a float32 as number 2 (a[0].y), found "one")");
}

TEST(PairFormat, ABrokenFieldIsNamed) {
  const std::string start = kZeros + " | name=x ";
  EXPECT_EQ(error_of(start + "note"), R"(in.pairs:1: expected a field key=value, found "note")");
  EXPECT_EQ(error_of(start + "=1"), R"(in.pairs:1: expected a field key=value, found "=1")");
  EXPECT_EQ(error_of(start + "note= 1"), R"(in.pairs:1: expected a field key=value, found "note=")");
  EXPECT_EQ(error_of(start + "no\"te=1"), R"(in.pairs:1: expected a field key=value, found "no\"te=1")");
  EXPECT_EQ(error_of(start + "name=y"), "in.pairs:1: expected every field once, found a second name");
  EXPECT_EQ(error_of(start + "note=\"a b"),
            "in.pairs:1: expected a closing quote in the value of note, found the end of the line");
  EXPECT_EQ(error_of(start + R"(note="a\n")"),
            R"(in.pairs:1: expected \", \\ or \xHH in the value of note, found "\\n")");
  EXPECT_EQ(error_of(start + "note=\"a\"b"), R"(in.pairs:1: expected white space after the value of note, found "b")");
}

TEST(PairFormat, GarbageIsEscapedAndCutShort) {
  EXPECT_EQ(error_of(std::string("\x7f"
                                 "ELF\x02\x01\0\x1b[31m",
                                 12)),
            R"(in.pairs:1: expected a float32 as number 1 (a[0].x), found "\x7fELF\x02\x01\x00\x1b")");
  EXPECT_EQ(error_of(std::string(1000, 'x')),
            "in.pairs:1: expected a float32 as number 1 (a[0].x), found \"" + std::string(40, 'x') + "\"...");
  EXPECT_EQ(error_of("\n" + std::string(1 << 20, '0')),
            "in.pairs:2: expected a line of at most 65536 bytes, found a longer one");
}

// Without a version line the reader takes what people paste.
TEST(PairFormat, TakesWhatPeoplePaste) {
  const Entry expected = read("0 0 0 4 0 0 0 4.5 0 1 1 0 1 2 4 2 1 4\n").at(0);
  const char* const kPasted[] = {
      "0, 0, 0, 4, 0, 0, 0, 4.5, 0, 1, 1, 0, 1, 2, 4, 2, 1, 4\n",
      "(0,0,0) (4,0,0) (0,4.5,0); (1,1,0) (1,2,4) (2,1,4)",
      "0 0 0\n4 0 0\n0 4.5 0\n\n1 1 0\n1 2 4\n2 1 4\n",
      "[[0, 0, 0], [4, 0, 0], [0, 4.5, 0]],\n[[1, 1, 0], [1, 2, 4], [2, 1, 4]]\n",
      "const float t[2][3][3] = {{{0.f, 0.0f, 0}, {4.0F, 0, 0}, {0, 4.5f, 0}},  // the first\n"
      "                          {{1, 1, 0}, {1, 2, 4}, {2, 1, 4}}};\n",
      "float t[18] =\n{\n0, 0, 0, 4,\n0, 0, 0, 4.5,\n0, 1, 1, 0, 1, 2, 4, 2, 1, 4\n};\n",
      "a = np.array([[0, 0, 0], [4, 0, 0], [0, 4.5, 0]])\nb = np.array([[1, 1, 0], [1, 2, 4], [2, 1, 4]])\n",
      "Vec3f a0(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4.5, 0)\nPoint_3(1, 1, 0) Point_3(1, 2, 4) K::Point_3{2, 1, 4}\n",
      "# fragment\no t\nv 0 0 0\nv 4 0 0\nv 0 4.5 0\nv 1 1 0\nv 1 2 4\nv 2 1 4\n",
      "v 2 1 4\nv 1 2 4\nv 1 1 0\nvn 0 0 1\nv 0 4.5 0\nv 4 0 0\nv 0 0 0\nf 6//1 5//1 4//1\nf 3 2 1\n"};
  for (const char* pasted : kPasted) {
    SCOPED_TRACE(pasted);
    ASSERT_EQ(error_of(pasted), "read 1 entries");
    const Entry found = read(pasted).at(0);
    for (int i = 0; i < kCoordinates; ++i) EXPECT_EQ(coordinates(found.pair)[i], coordinates(expected.pair)[i]) << i;
    ASSERT_EQ(found.written.size(), 18u);
    EXPECT_TRUE(found.written[7] == "4.5") << found.written[7];
  }
  EXPECT_EQ(read("{0,0,0}\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0 | name=x\n" + kZeros).size(), 2u);
}

TEST(PairFormat, PastedTextThatIsNoPairIsNamed) {
  EXPECT_EQ(error_of("0 0 0\n" + kZeros), "in.pairs:1: expected 18 numbers, found 21");
  EXPECT_EQ(error_of("\n0 0 0\n0 0 0\n"), "in.pairs:2: expected 18 numbers, found 6");
  EXPECT_EQ(error_of("0 0\n0 0 0 0\n"), "in.pairs:1: expected 18 numbers, found 2");
  EXPECT_EQ(error_of("graze-pairs 1\n0 0 0\n" + kZeros), "in.pairs:2: expected 18 numbers, found 3");
  EXPECT_EQ(error_of("0 0 0\ngraze-pairs 1\n"), "in.pairs:1: expected 18 numbers, found 3");
  EXPECT_EQ(error_of("1.5g 0 0"), R"(in.pairs:1: expected a float32 as number 1 (a[0].x), found "1.5g")");
  EXPECT_EQ(error_of("point 7 (0 0 0)"), R"(in.pairs:1: expected a float32 as number 1 (a[0].x), found "point")");
  EXPECT_EQ(error_of("0x1ff 0 0"), "in.pairs:1: expected 18 numbers, found 3");  // a number in hex, not a suffix
  EXPECT_EQ(error_of("\nv 0 0 0\nv 1 0\n"),
            "in.pairs:3: expected a coordinate that is finite in float32, found the end of the line");
  EXPECT_EQ(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            "in.pairs:1: expected two triangles, or six vertices without a face; found 1 triangles and 3 vertices");
}

TEST(PairFormat, KeepsWhatWasTyped) {
  const Entry entry = read("0.1 1.00000000001 -0x1.8p1 +1e0 0 0 0 0 0 0 0 0 0 0 0 0 0 1f\n").at(0);
  EXPECT_EQ(entry.written[0], "0.1");
  EXPECT_EQ(entry.written[1], "1.00000000001");
  EXPECT_EQ(entry.written[2], "-0x1.8p1");
  EXPECT_EQ(entry.written[3], "+1e0");
  EXPECT_EQ(entry.written[17], "1");
}

TEST(PairReader, GoesOnAfterABadLine) {
  std::istringstream in("bad\n" + kZeros + "\n");
  PairReader reader(in, "in.pairs");
  EXPECT_THROW(reader.next(), FormatError);
  EXPECT_TRUE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST(ReadPairs, NamesTheFile) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("graze_pair_format_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto file = folder / "bad.pairs";
  std::ofstream(file) << "graze-pairs 1\n1 2 3\n";
  const auto error = [](const std::filesystem::path& path) {
    try {
      read_pairs(path);
      return std::string("none");
    } catch (const FormatError& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(error(file), file.string() + ":2: expected 18 numbers, found 3");
  EXPECT_EQ(error(folder), folder.string() + ": expected a file of pairs, found a folder");
  EXPECT_EQ(error(folder / "none"), (folder / "none").string() + ": expected a file of pairs, found none");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace graze::corpus
