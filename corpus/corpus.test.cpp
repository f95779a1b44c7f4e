// SPDX-License-Identifier: Apache-2.0
// Every entry in every corpus file is a separate test, which compares its fields `truth` and `contact` with the oracle.
// For a pair of doubles the test also compares `truth_in_float32` and `contact_in_float32`.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "corpus/pair_format.h"
#include "oracle/truth.h"

namespace graze::corpus {
namespace {

struct Case {
  std::string name;            // FOLDER_NAME, the test's name
  std::filesystem::path file;  // relative to the root of the sources
  Entry entry;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.file.string() << ':' << c.entry.line; }

struct Corpus {
  std::vector<Case> cases;
  std::string errors;  // one line for each unreadable file and each entry without a name
};

Corpus read_corpus() {
  const std::filesystem::path root = GRAZE_SOURCE_DIR;
  std::vector<std::filesystem::path> files;
  for (const auto& item : std::filesystem::recursive_directory_iterator(root / "corpus")) {
    if (item.path().extension() == ".pairs") files.push_back(item.path());
  }
  std::sort(files.begin(), files.end());

  Corpus corpus;
  for (const auto& file : files) {
    try {
      for (Entry& entry : read_pairs(file, PairTypes::both)) {
        const std::string* name = field(entry, "name");
        if (!name) {
          corpus.errors +=
              file.string() + ':' + std::to_string(entry.line) + ": expected name=…, found no such field\n";
          continue;
        }
        const std::string test_name = file.parent_path().filename().string() + '_' + *name;
        corpus.cases.push_back({test_name, file.lexically_relative(root), std::move(entry)});
      }
    } catch (const FormatError& error) {
      corpus.errors += std::string(error.what()) + '\n';
    }
  }
  return corpus;
}

const Corpus& corpus() {
  static const Corpus kCorpus = read_corpus();
  return kCorpus;
}

std::string value(const Entry& entry, std::string_view key) {
  const std::string* found = field(entry, key);
  return found ? *found : "no field " + std::string(key);
}

TEST(Corpus, EveryFileReads) { EXPECT_EQ(corpus().errors, ""); }

// An empty corpus fails here, and also because GoogleTest fails a parameterised test that has no parameters.
TEST(Corpus, HasEntriesOfEveryKind) {
  std::set<std::string> contacts;
  for (const Case& c : corpus().cases) contacts.insert(value(c.entry, "contact"));
  EXPECT_EQ(contacts, (std::set<std::string>{"area", "none", "point", "segment", "unknown"}));
}

TEST(Corpus, NamesAreUnique) {
  std::set<std::string> names;
  for (const Case& c : corpus().cases) {
    EXPECT_TRUE(names.insert(value(c.entry, "name")).second) << c << ": a second " << value(c.entry, "name");
  }
}

class Truth : public testing::TestWithParam<Case> {};

TEST_P(Truth, MatchesTheOracle) {
  const Entry& entry = GetParam().entry;
  const oracle::Truth truth = visit(entry, [](const auto& pair) { return oracle::truth(pair); });
  EXPECT_EQ(value(entry, "truth"), name(truth.verdict));
  EXPECT_EQ(value(entry, "contact"), name(truth.contact));
  if (!entry.doubles) return;
  const oracle::Truth stored = oracle::truth(entry.pair);
  EXPECT_EQ(value(entry, "truth_in_float32"), name(stored.verdict));
  EXPECT_EQ(value(entry, "contact_in_float32"), name(stored.contact));
}

INSTANTIATE_TEST_SUITE_P(corpus, Truth, testing::ValuesIn(corpus().cases),
                         [](const testing::TestParamInfo<Case>& test) { return test.param.name; });

}  // namespace
}  // namespace graze::corpus
