// SPDX-License-Identifier: Apache-2.0
// `graze dump` as users run it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class Dump : public CommandTest {};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

// Every row agrees with `graze check` on a pair with the row's coordinates.
TEST_F(Dump, ATableSaysWhatCheckSays) {
  const Ran ran = shell.done(
      "graze dump near_edge_edge:7 --pairs 20 --lanes 'moller_1997/f32/cpu,exact/f32/cpu' > t.csv; cat t.csv");
  std::istringstream lines(ran.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "stratum,seed,index,a0x,a0y,a0z,a1x,a1y,a1z,a2x,a2y,a2z,b0x,b0y,b0z,b1x,b1y,b1z,b2x,b2y,b2z,truth,contact,"
            "margin,margin_ulps,moller_1997/f32/cpu,exact/f32/cpu");
  std::ofstream pairs(shell.folder / "typed.pairs");
  std::vector<std::vector<std::string>> rows;
  while (std::getline(lines, line)) {
    rows.push_back(cells_of(line));
    ASSERT_EQ(rows.back().size(), 27u) << line;
    for (std::size_t i = 3; i < 21; ++i) pairs << rows.back()[i] << (i < 20 ? ' ' : '\n');
  }
  pairs.close();
  ASSERT_EQ(rows.size(), 20u);
  const Ran check = shell.done("graze check typed.pairs --json --lanes 'moller_1997/f32/cpu,exact/f32/cpu'");
  std::istringstream objects(check.out);
  for (std::size_t i = 0; std::getline(objects, line); ++i) {
    const auto object = nlohmann::json::parse(line);
    const auto& row = rows.at(i);
    EXPECT_EQ(row[0] + ':' + row[1] + ':' + row[2], "near_edge_edge:7:" + std::to_string(i));
    EXPECT_EQ(object["truth"]["verdict"].get<std::string>(), row[21]);
    EXPECT_EQ(object["truth"]["contact"].get<std::string>(), row[22]);
    EXPECT_EQ(object["truth"]["margin"].get<double>(), std::stod(row[23]));
    EXPECT_EQ(object["truth"]["margin_ulps"].get<double>(), std::stod(row[24]));
    EXPECT_EQ(object["lanes"]["moller_1997/f32/cpu"].get<std::string>(), row[25]);
    EXPECT_EQ(object["lanes"]["exact/f32/cpu"].get<std::string>(), row[26]);
  }
}

// Returns a field's value from a line of a file of pairs.
std::string field_of(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(' ' + key + '=') + key.size() + 2;
  return line.substr(at, line.find(' ', at) - at);
}

TEST_F(Dump, PairsReadBackWithTheSameTruth) {
  expect_done("graze dump 'lattice:5' --format pairs --pairs 40 --lanes 'exact/f32/cpu,moller_1997/f32/cpu' > l.pairs");
  const Ran check = shell.done("graze check l.pairs --json --exact-input --lanes 'exact/f32/cpu,moller_1997/f32/cpu'");
  std::istringstream lines(shell.file("l.pairs")), objects(check.out);
  std::string line, text;
  std::getline(lines, line);
  EXPECT_EQ(line, "graze-pairs 1");
  int index = 0;
  for (; std::getline(lines, line) && std::getline(objects, text); ++index) {
    const auto object = nlohmann::json::parse(text);
    EXPECT_EQ(field_of(line, "index"), std::to_string(index));
    EXPECT_EQ(field_of(line, "truth"), object["truth"]["verdict"].get<std::string>());
    EXPECT_EQ(field_of(line, "contact"), object["truth"]["contact"].get<std::string>());
    EXPECT_EQ(std::stod(field_of(line, "margin")), object["truth"]["margin"].get<double>());
    EXPECT_EQ(field_of(line, "moller_1997.f32.cpu"), object["lanes"]["moller_1997/f32/cpu"].get<std::string>());
    EXPECT_EQ(field_of(line, "exact.f32.cpu"), object["lanes"]["exact/f32/cpu"].get<std::string>());
  }
  EXPECT_EQ(index, 40);
  expect_done("graze repro l.pairs > /dev/null");  // stratum, seed and index name the same pairs
}

TEST_F(Dump, PythonReadsTheTable) {
  if (shell("command -v python3").status != 0) GTEST_SKIP() << "no python3";
  std::ofstream(shell.folder / "read.py") << R"(import csv, struct, sys
rows = list(csv.DictReader(open('t.csv', newline='')))
assert len(rows) == 60, len(rows)
for row in rows:
    assert None not in row and None not in row.values(), row
    assert row['truth'] in ('intersects', 'disjoint') and row['exact/f32/cpu'] == row['truth'], row
    assert (float(row['margin']) > 0) == (row['truth'] == 'disjoint'), row
    for name in ('a0x', 'b2z'):
        x = float(row[name])
        assert struct.unpack('f', struct.pack('f', x))[0] == x, row
)";
  expect_done("graze dump 'near_*' --pairs 60 --lanes exact/f32/cpu > t.csv && python3 read.py");
}

// A dump of a hundred times as many pairs needs no more memory, because rows are written as they are made.
TEST_F(Dump, IsWrittenAsItIsMade) {
  if (shell("command -v python3").status != 0) GTEST_SKIP() << "no python3";
  std::ofstream(shell.folder / "peak.py") << R"(import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
)";
  for (const char* format : {"csv", "pairs"}) {
    const auto peak = [&](const char* pairs) {
      return std::stoi(
          shell(std::string("python3 peak.py graze dump uniform --format ") + format + " --pairs " + pairs).out);
    };
    EXPECT_LT(peak("20000"), peak("200") + 2048) << format;  // in KiB; the text is about 8 MiB
  }
}

TEST_F(Dump, ACampaignIsAllOfItsPairs) {
  expect_done(
      "graze fuzz --seed 3 --pairs 50 --strata 'lattice,thesis' --lanes exact/f32/cpu --out 'c d' > /dev/null && "
      "graze dump 'c d' > c.csv && test $(wc -l < c.csv) = 51 && "
      "graze dump lattice:3 --pairs 25 > l.csv && graze dump thesis:3 --pairs 25 | tail -n +2 >> l.csv");
  expect_done("sort c.csv > 1; sort l.csv > 2; cmp 1 2");
  EXPECT_EQ(shell("graze dump 'c d' --pairs 3 | wc -l").out, "4\n");
}

TEST_F(Dump, AMeshesPairsAreReadAgain) {
  std::ofstream(shell.folder / "strip.off") << "OFF\n4 2 0\n0 0 0\n4 0 0\n0 4 0\n4 4 0\n3 0 1 2\n3 1 3 2\n";
  expect_done(
      "graze fuzz --mesh strip.off --lanes exact/f32/cpu --out m > /dev/null && graze dump m | grep -q "
      "'^mesh,1,0,'");
  expect_error("echo '# other' >> strip.off; graze dump m", 1, {"strip.off", "changed"});
}

TEST_F(Dump, BadInputGetsOneLine) {
  expect_error("graze dump", 2, {"SOURCE"});
  expect_error("graze dump latice", 2, {"'latice'", "'lattice'"});
  expect_error("graze dump lattice:x", 2, {"STRATUM:SEED", "'x'"});
  expect_error("graze dump lattice --format xml", 2, {"pairs", "csv", "'xml'"});
  expect_error("mkdir e; graze dump e", 1, {"e", "summary.json"});
  expect_error("graze dump no/where", 1, {"no/where", "summary.json"});
  expect_error("mkdir o; echo '{\"spec\": {}}' > o/summary.json; graze dump o", 1, {"o/summary.json"});
  expect_error("graze dump lattice --lanes nothing", 2, {"'nothing'"});
}

}  // namespace
}  // namespace graze::cli
