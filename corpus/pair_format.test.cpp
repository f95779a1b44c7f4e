// SPDX-License-Identifier: Apache-2.0
// The text format: written pairs are read back bit for bit, decimals are rounded once, and each error has its message.
#include "corpus/pair_format.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "core/message_testing.h"
#include "core/text.h"

namespace graze::corpus {
namespace {

constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

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

void expect_named(const std::string& text, const std::vector<std::string>& words) {
  EXPECT_TRUE(names(error_of(text), words)) << text.substr(0, 200);
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
    const auto value = std::bit_cast<float>(pattern);
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
  expect_named("\ngraze-pairs 2\n", {"in.pairs:2", "graze-pairs 1", "graze-pairs 2"});
  expect_named("graze-pairs\n", {"in.pairs:1", "graze-pairs 1", "graze-pairs"});
}

TEST(PairFormat, AWrongCountIsNamed) {
  expect_named(kSeventeen, {"in.pairs:1", "18", "17"});
  expect_named("\n" + kSeventeen + " # 0", {"in.pairs:2", "18", "17"});
  expect_named(kSeventeen + " | name=x", {"in.pairs:1", "18", "17"});
  expect_named("| name=x", {"in.pairs:1", "18", "0"});
  expect_named(kZeros + " 0 0", {"in.pairs:1", "18", "20"});
  expect_named(kZeros + " name=x", {"in.pairs:1", "18", "name=x"});
}

TEST(PairFormat, AWordThatIsNoNumberIsNamed) {
  expect_named("0 0 0 0 one 0", {"in.pairs:1", "a number", "5", "a[1].y", "one"});
  expect_named(kSeventeen + " 1e39", {"in.pairs:1", "float32", "18", "b[2].z", "1e39"});
  expect_named("0,one,0", {"in.pairs:1", "a number", "2", "a[0].y", "one"});
}

TEST(PairFormat, ABrokenFieldIsNamed) {
  const std::string start = kZeros + " | name=x ";
  expect_named(start + "note", {"in.pairs:1", "key=value", "note"});
  expect_named(start + "=1", {"in.pairs:1", "key=value", "=1"});
  expect_named(start + "note= 1", {"in.pairs:1", "key=value", "note="});
  expect_named(start + "no\"te=1", {"in.pairs:1", "key=value", R"(no\"te=1)"});
  expect_named(start + "name=y", {"in.pairs:1", "name"});
  expect_named(start + "note=\"a b", {"in.pairs:1", "quote", "note"});
  expect_named(start + R"(note="a\n")", {"in.pairs:1", R"(\xHH)", "note", R"(\\n)"});
  expect_named(start + "note=\"a\"b", {"in.pairs:1", "note", "b"});
}

TEST(PairFormat, GarbageIsEscapedAndCutShort) {
  expect_named(std::string("\x7f"
                           "ELF\x02\x01\0\x1b[31m",
                           12),
               {"in.pairs:1", "1", "a[0].x", R"(\x7fELF\x02\x01\x00\x1b)"});
  expect_named(std::string(1000, 'x'), {"in.pairs:1", "a[0].x", '"' + std::string(40, 'x') + "\"..."});
  expect_named("\n" + std::string(1 << 20, '0'), {"in.pairs:2", "65536"});
}

// Without a version line, the reader accepts pasted text.
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
  expect_named("0 0 0\n" + kZeros, {"in.pairs:1", "18", "21"});
  expect_named("\n0 0 0\n0 0 0\n", {"in.pairs:2", "18", "6"});
  expect_named("0 0\n0 0 0 0\n", {"in.pairs:1", "18", "2"});
  expect_named("graze-pairs 1\n0 0 0\n" + kZeros, {"in.pairs:2", "18", "3"});
  expect_named("0 0 0\ngraze-pairs 1\n", {"in.pairs:1", "18", "3"});
  expect_named("1.5g 0 0", {"in.pairs:1", "1", "a[0].x", "1.5g"});
  expect_named("point 7 (0 0 0)", {"in.pairs:1", "1", "a[0].x", "point"});
  expect_named("0x1ff 0 0", {"in.pairs:1", "18", "3"});  // the f is a hex digit, not a suffix
  expect_named("\nv 0 0 0\nv 1 0\n", {"in.pairs:3", "coordinate", "float32"});
  expect_named("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {"in.pairs:1", "triangles", "vertices", "1", "3"});
}

TEST(PairFormat, KeepsWhatWasTyped) {
  const Entry entry = read("0.1 1.00000000001 -0x1.8p1 +1e0 0 0 0 0 0 0 0 0 0 0 0 0 0 1f\n").at(0);
  EXPECT_EQ(entry.written[0], "0.1");
  EXPECT_EQ(entry.written[1], "1.00000000001");
  EXPECT_EQ(entry.written[2], "-0x1.8p1");
  EXPECT_EQ(entry.written[3], "+1e0");
  EXPECT_EQ(entry.written[17], "1");
}

std::optional<Entry> read_any(const std::string& text) {
  std::istringstream in(text);
  return PairReader(in, "in.pairs", PairTypes::both).next();
}

TEST(PairFormat, APairOfDoublesReadsBack) {
  constexpr double kValues[] = {0.1,         -0.0,   0x1p-1074, -0x1.fffffffffffffp1023, 1.0 / 3, 5,
                                0x1.8p-1023, -1e300, 0x1p-149};
  DoublePair pair;
  for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = kValues[i % 9];
  const std::string text = write(entry_of(pair, {{"name", "x"}}));
  EXPECT_NE(text.find(" | coordinates=f64 name=x\n"), std::string::npos) << text;
  const Entry again = read_any(text).value();
  ASSERT_TRUE(again.doubles);
  EXPECT_EQ(std::memcmp(&*again.doubles, &pair, sizeof pair), 0);
  EXPECT_EQ(coordinates(again.pair)[0], 0.1f);
  EXPECT_EQ(write(again), text);
  const Entry on_float32 = read_any(write(entry_of(in_doubles(Pair{}), {}))).value();
  EXPECT_TRUE(on_float32.doubles);  // the file states f64, although float32 holds its numbers
}

TEST(PairFormat, TheTypeIsTheNarrowestThatHoldsTheNumbersUnlessTheFileSaysIt) {
  const auto is_double = [](const std::string& number, const std::string& rest = "") {
    return read_any(number + ' ' + kSeventeen + rest).value().doubles.has_value();
  };
  for (const char* number : {"0.1", "1e-60", "3.4028235e38", "0x1.fffffep127", "0x1p-149", "nan", "-inf", "1.5f"})
    EXPECT_FALSE(is_double(number)) << number;
  for (const char* number : {"0x1.0000001p0", "0x1p-150", "0x1.ffffffp127", "1e39", "-1e300", "0x1p1023"})
    EXPECT_TRUE(is_double(number)) << number;
  EXPECT_TRUE(is_double("0.1", " | coordinates=f64"));
  EXPECT_FALSE(is_double("0.1", " | coordinates=f32"));
  EXPECT_EQ(coordinates(*read_any("0.1 " + kSeventeen + " | coordinates=f64").value().doubles)[0], 0.1);
}

TEST(PairFormat, DoublesWhereTheyAreNotTakenAreNamed) {
  expect_named("1e39 " + kSeventeen, {"in.pairs:1", "number 1", "a[0].x", "1e39"});
  expect_named(kSeventeen + " 0x1.0000001p0", {"in.pairs:1", "number 18", "b[2].z"});
  expect_named("0 " + kSeventeen + " | coordinates=f64", {"in.pairs:1", "coordinates=f64"});
  expect_named("1e39 " + kSeventeen + " | coordinates=f32", {"in.pairs:1", "number 1", "coordinates=f32"});
  expect_named("0 " + kSeventeen + " | coordinates=f16", {"in.pairs:1", "f16"});
  expect_named("1e400 " + kSeventeen, {"in.pairs:1", "number 1", "1e400"});
  EXPECT_THROW(read_any("1e400 " + kSeventeen), FormatError);
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
  EXPECT_TRUE(names(error(file), {file.string() + ":2", "18", "3"}));
  EXPECT_TRUE(names(error(folder), {folder.string(), "Is a directory"}));
  EXPECT_TRUE(names(error(folder / "none"), {(folder / "none").string(), "No such file or directory"}));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace graze::corpus
