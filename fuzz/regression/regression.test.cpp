// SPDX-License-Identifier: Apache-2.0
// Tests the regression corpus with lanes that the tests make wrong: the changes that verify reports, and the states of
// a case.
#include "fuzz/regression/regression.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/message_testing.h"
#include "fuzz/regression/found_failure.h"

namespace graze::fuzz {
namespace {

// A vertex of b on the face of a: the triangles touch.
constexpr Pair kTouching{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 2, 4}, {2, 1, 4}}};
constexpr Pair kShifted{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{2, 1, 0}, {2, 2, 4}, {3, 1, 4}}};
const std::string kSignature = "point/22/skew/0/moller_1997:-f32/cpu";

// All lanes. The lanes in `wrong` give the verdict disjoint, which is wrong on these pairs; the other lanes are right.
struct Liars {
  std::vector<const Lane*> lanes;
  std::set<std::string> wrong{"moller_1997/f32/cpu"};
  std::set<std::string> alternating;  // lanes that are wrong on every second call
  std::set<std::string> apart;
  int calls = 0;

  Liars() {
    for (const Lane& lane : published_lanes()) lanes.push_back(&lane);
  }
  DecideLanes decide() {
    return [this](const AnyPair&, std::vector<const Lane*>& differ) {
      ++calls;
      std::vector<Verdict> verdicts;
      for (const Lane* lane : lanes) {
        const bool lies = wrong.contains(lane->id) || (alternating.contains(lane->id) && calls % 2 == 0);
        verdicts.push_back(lies ? Verdict::disjoint : Verdict::intersects);
        if (apart.contains(lane->id)) differ.push_back(lane);
      }
      return verdicts;
    };
  }
};

struct Regression : testing::Test {
  Liars liars;
  RegressionCorpus corpus;
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".pairs");

  void SetUp() override {
    std::filesystem::remove(file);
    ASSERT_EQ(add({kSignature, {kTouching, {{"stratum", "lattice"}}}, 7, "here; campaign 1"}), Added::as_new);
  }
  Added add(const FoundFailure& failure) { return fuzz::add(corpus, failure, liars.lanes, liars.decide()); }
  std::vector<std::string> changes() {
    std::vector<std::string> texts;
    for (const Change& change : verify(corpus, liars.lanes, liars.decide()).changes) texts.push_back(change.what);
    return texts;
  }
  RegressionCase& only() { return corpus.begin()->second; }
  std::string read_error(const std::string& from, const std::string& to) {
    write_regressions(file, corpus);
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::string bad = text.str();
    bad.replace(bad.find(from), from.size(), to);
    std::ofstream(file) << bad;
    const std::string error = error_of<corpus::FormatError>([&] { read_regressions(file); });
    return error.substr(std::min(error.size(), file.string().size()));
  }
};

using Texts = std::vector<std::string>;

TEST_F(Regression, AFileReadsAsItWasWritten) {
  write_regressions(file, corpus);
  const RegressionCorpus read = read_regressions(file);
  ASSERT_EQ(read.size(), 1u);
  const RegressionCase &c = read.at(kSignature), &was = only();
  EXPECT_EQ(
      std::tie(c.name, c.truth, c.contact, c.state, c.count, c.marks, c.first, c.last, c.other),
      std::tie(was.name, was.truth, was.contact, was.state, was.count, was.marks, was.first, was.last, was.other));
  EXPECT_EQ(c.truth, "intersects");
  EXPECT_EQ(c.contact, "point");
  EXPECT_EQ(c.count, 7u);
  EXPECT_EQ(c.other, (std::vector<std::pair<std::string, std::string>>{{"stratum", "lattice"}}));
}

TEST_F(Regression, EveryMarkIsReadAgain) {
  only().marks = {{"mine/f32/cpu", '!'}, {"mine/f32/cpu-fma", '@'}, {"mine/f64/cpu", '%'}, {"mine/f64/cpu-fma", '~'}};
  write_regressions(file, corpus);
  EXPECT_EQ(read_regressions(file).at(kSignature).marks, only().marks);
}

TEST_F(Regression, BadLinesAreNamed) {
  EXPECT_TRUE(names(read_error("state=failing", "state=broken"), {":3", "failing", "fixed", "flaky", "'broken'"}));
  EXPECT_TRUE(names(read_error("count=7", "count=-7"), {":3", "count", "'-7'"}));
  EXPECT_TRUE(names(read_error("count=7", "times=7"), {":3", "count"}));
  EXPECT_TRUE(
      names(read_error("lanes=guigue_devillers_2003:", "lanes=;guigue_devillers_2003:"), {":3", "lanes", "''"}));
  EXPECT_TRUE(
      names(read_error("moller_1997:-f32/cpu,", "moller_1997:f32/cpu,-f32/cpu,"), {":3", "moller_1997", "lanes"}));
  EXPECT_TRUE(names(read_error("signature=" + kSignature, "signature=point"), {":3", "signature", "'point'"}));
  EXPECT_TRUE(names(read_error("name=moller_1997_", "name=other_"), {":3", "signature", "'other_984a73f8aa2b1c68'"}));
  EXPECT_TRUE(names(read_error("skew/0/moller_1997:-f32/cpu", "skew/-2^-3/moller_1997:-f32/cpu"), {":3", "signature"}));
  EXPECT_TRUE(names(read_error("count=7", "count=0"), {":3", "count", "'0'"}));
  EXPECT_TRUE(names(read_error("count=7", "count=18446744073709551615"), {":3", "count"}));
  EXPECT_TRUE(names(read_error("moller_1997:-f32/cpu,", "moller_1997:-f32/cpu,.f32/cpu,"), {":3", "second"}));
  EXPECT_TRUE(names(read_error("stratum=lattice\n", "stratum=lat"), {"cut off"}));
  write_regressions(file, corpus);
  const corpus::Entry twice = corpus::read_pairs(file).front();
  std::ofstream again(file, std::ios::app);
  corpus::write_entry(again, twice);
  again.close();
  EXPECT_THROW(read_regressions(file), corpus::FormatError);
}

TEST_F(Regression, ASignatureIsStoredOnceAndCounted) {
  EXPECT_EQ(add({kSignature, {kShifted}, 5, "there; campaign 2"}), Added::seen_again);
  EXPECT_EQ(corpus.size(), 1u);
  EXPECT_EQ(only().count, 12u);
  EXPECT_EQ(only().first, "here; campaign 1");
  EXPECT_EQ(only().last, "there; campaign 2");
  EXPECT_EQ(only().pair.floats->b[0].x, 1);  // the first pair is kept
  EXPECT_EQ(add({kSignature, {kShifted}, 5, "there; campaign 2"}), Added::known);
  EXPECT_EQ(only().count, 12u);
}

TEST_F(Regression, APairOfAnotherSignatureIsRefused) {
  EXPECT_THROW(add({"area/22/coplanar/0/moller_1997:-f32/cpu", {kTouching}, 1, "s"}), std::runtime_error);
  EXPECT_THROW(add({"nonsense", {kTouching}, 1, "s"}), std::runtime_error);
  EXPECT_EQ(corpus.size(), 1u);
}

TEST_F(Regression, NothingChangedIsNoChange) { EXPECT_EQ(changes(), Texts()); }

TEST_F(Regression, EveryLaneIsCompared) {
  EXPECT_EQ(verify(corpus, liars.lanes, liars.decide()).compared, published_lanes().size());
  liars.wrong.insert("separating_axes/f64/cuda-fma");
  EXPECT_EQ(changes(), Texts{"separating_axes/f64/cuda-fma: was intersects (right), is disjoint (wrong)"});
  EXPECT_EQ(changes(), Texts());  // the change is recorded already
}

TEST_F(Regression, AFailingCaseIsFixedAndFailsAgain) {
  liars.wrong.clear();
  EXPECT_EQ(changes(), (Texts{"moller_1997/f32/cpu: was disjoint (wrong), is intersects (right)", "failing -> fixed"}));
  liars.wrong = {"moller_1997/f64/cuda-fma"};  // any lane of the case's algorithm may be wrong
  EXPECT_EQ(changes(),
            (Texts{"moller_1997/f64/cuda-fma: was intersects (right), is disjoint (wrong)", "fixed -> failing"}));
}

TEST_F(Regression, AFixedCaseTakesThePairThatFailsAgain) {
  liars.wrong.clear();
  changes();
  EXPECT_EQ(add({kSignature, {kShifted}, 1, "s2"}), Added::seen_again);
  EXPECT_EQ(only().state, CaseState::fixed);  // it failed in another build, but not in this one
  liars.wrong = {"moller_1997/f32/cpu"};
  EXPECT_EQ(add({kSignature, {kShifted}, 1, "s3"}), Added::seen_again);
  EXPECT_EQ(only().state, CaseState::failing);
  EXPECT_EQ(only().pair.floats->b[0].x, 2);
  EXPECT_EQ(only().count, 9u);
  EXPECT_EQ(only().first, "here; campaign 1");
  EXPECT_EQ(changes(), Texts());
}

// A minimised pair has a different margin, but is still stored under the campaign's signature.
TEST_F(Regression, AMinimisedPairIsTheCaseOfItsSignature) {
  std::string other = kSignature;
  other.replace(other.find("/0/"), 3, "/-2^-3/");
  EXPECT_THROW(add({other, {kTouching}, 2, "s2"}), std::runtime_error);
  EXPECT_EQ(add({other, {kTouching, {{"signature", kSignature}}}, 2, "s2"}), Added::as_new);
  EXPECT_EQ(corpus.at(other).count, 2u);
  EXPECT_EQ(corpus.at(kSignature).count, 7u);
  write_regressions(file, corpus);
  EXPECT_EQ(read_regressions(file).size(), 2u);
}

TEST_F(Regression, LanesThatDoNotRunChangeNothing) {
  const Marks before = only().marks;
  liars.lanes.erase(std::remove_if(liars.lanes.begin(), liars.lanes.end(),
                                   [](const Lane* lane) { return lane->info->id == "moller_1997"; }),
                    liars.lanes.end());
  EXPECT_EQ(changes(), Texts());
  EXPECT_EQ(only().marks, before);
  EXPECT_EQ(only().state, CaseState::failing);
  EXPECT_EQ(verify(corpus, {}, liars.decide()).compared, 0u);
}

TEST_F(Regression, VerdictsThatDifferBetweenReplaysAreFlakyForGood) {
  liars.alternating = {"moller_1997/f64/cpu"};
  EXPECT_EQ(changes(),
            (Texts{"moller_1997/f64/cpu: was intersects (right), is different in each replay", "failing -> flaky"}));
  liars.alternating.clear();
  EXPECT_EQ(changes(), Texts());
  EXPECT_EQ(only().state, CaseState::flaky);
}

TEST_F(Regression, ExecutorsThatDifferAreFlaky) {
  liars.apart = {"interval_overlap/f32/cuda-fma"};
  EXPECT_EQ(changes(), (Texts{"interval_overlap/f32/cuda-fma: was intersects (right), is different in each replay",
                              "failing -> flaky"}));
}

TEST_F(Regression, AnEditedTruthShows) {
  only().contact = "area";
  EXPECT_EQ(changes(), Texts{"truth: was intersects, area, is intersects, point"});
  only().state = CaseState::fixed;
  EXPECT_EQ(changes(), Texts{"fixed -> failing"});
}

TEST(Failures, OfACaseAreAllItsWrongAlgorithms) {
  Liars liars;
  liars.wrong.insert("separating_axes/f32/cpu");
  const Json build{{"commit", "c"}, {"compiler", "GNU 1"}, {"cuda", nullptr}, {"device", "H100"}, {"executors", {}}};
  const auto found = found_in_cases({{kTouching}, {kShifted}}, build, liars.lanes, liars.decide());
  ASSERT_EQ(found.size(), 2u);  // the second pair has the same two signatures
  EXPECT_EQ(found[0].signature, kSignature);
  EXPECT_EQ(found[1].signature, "point/22/skew/0/separating_axes:-f32/cpu");
  EXPECT_TRUE(found[0].seen.starts_with("c, GNU 1, no nvcc, H100; case ")) << found[0].seen;
  EXPECT_EQ(found[0].seen, found_in_cases({{kTouching}}, build, liars.lanes, liars.decide())[0].seen);
  EXPECT_NE(found[0].seen, found_in_cases({{kShifted}}, build, liars.lanes, liars.decide())[0].seen);
}

// If the file has no mark for an exact lane, the lane is compared with the truth.
TEST_F(Regression, AnExactLaneThatIsWrongIsAChange) {
  for (const Lane& lane : lanes()) {
    if (lane.id == "exact/f32/cpu") liars.lanes.push_back(&lane);
  }
  EXPECT_EQ(verify(corpus, liars.lanes, liars.decide()).compared, published_lanes().size() + 1);
  EXPECT_TRUE(changes().empty());
  liars.wrong.insert("exact/f32/cpu");
  const Verified found = verify(corpus, liars.lanes, liars.decide());
  ASSERT_EQ(found.changes.size(), 1u);
  EXPECT_TRUE(names(found.changes[0].what, {"exact/f32/cpu", "intersects", "disjoint (wrong)"}));
}

TEST_F(Regression, ARecordOfAnExactLaneThatIsNotTheTruthIsAChange) {
  for (const Lane& lane : lanes()) {
    if (lane.id == "exact/f32/cpu") liars.lanes.push_back(&lane);
  }
  for (const char mark : {'?', '-', '~'}) {
    corpus.begin()->second.marks["exact/f32/cpu"] = mark;
    const Verified found = verify(corpus, liars.lanes, liars.decide());
    ASSERT_EQ(found.changes.size(), 1u) << mark;
    EXPECT_TRUE(names(found.changes[0].what, {"exact/f32/cpu", "intersects (right)"}));
  }
}

}  // namespace
}  // namespace graze::fuzz
