// SPDX-License-Identifier: Apache-2.0
#include "reports/own_code.h"

#include "core/message_testing.h"
#include "reports/findings.h"
#include "reports/test_campaign.h"

namespace graze::reports {
namespace {

Json summary_of_mine() {
  Json summary = summary_of({"moller_1997/f32/cpu", "exact/f32/cpu", "mine/f32/cpu", "mine/f32/cpu-fma"},
                            {"uniform", "coplanar_wide"}, {});
  Json& strata = summary["strata"];
  strata["uniform"]["lanes"]["mine/f32/cpu"]["false_positive"] = 2;
  strata["coplanar_wide"]["lanes"]["mine/f32/cpu"]["false_negative"] = 31;
  strata["coplanar_wide"]["lanes"]["mine/f32/cpu"]["crashed"] = 1;
  strata["coplanar_wide"]["lanes"]["mine/f32/cpu-fma"] = {
      {"false_positive", 0}, {"false_negative", 40}, {"declined", 0}, {"differs_from_cpu", 9}};
  return summary;
}

Json kind_of(const std::string& subject, const std::string& cause, const std::string& shape, int pairs) {
  return {{"subject", subject},
          {"cause", cause},
          {"line", ""},
          {"shape", shape},
          {"pairs", pairs},
          {"intersecting", pairs},
          {"settled", {3, 3}},
          {"lanes", {subject + "/f32/cpu"}},
          {"simplest",
           {{"case", "cases/" + cause + ".pairs"},
            {"lanes", {subject + "/f32/cpu"}},
            {"pair",
             "0x0p+0 0x0p+0 0x0p+0 0x1p+0 0x0p+0 0x0p+0 0x0p+0 0x1p+0 0x0p+0 0x1.99999ap-4 0x0p+0 0x0p+0 0x1p+0 "
             "0x0p+0 0x0p+0 0x0p+0 0x1p+0 -0x1p-3"},
            {"sentences", {subject + " says disjoint."}}}}};
}

TEST(OwnCode, IsTheDefaultBuildOfEachSubjectThatIsNotOurs) {
  const auto ids_of = [](const std::vector<std::string>& lanes) {
    const CampaignCounts counts = counts_of(summary_of(lanes, {"uniform"}, {}));
    return ids(counts, own_lanes(counts));
  };
  EXPECT_EQ(ids_of({"moller_1997/f32/cpu", "exact/f32/cpu"}), "");
  EXPECT_EQ(ids_of({"exact/f32/cpu", "a/f32/cpu-fma", "a/f32/cpu", "a/f64/cpu", "b/f32/cuda-nofma", "b/f32/cuda-fma"}),
            "a/f32/cpu and b/f32/cuda-fma");
  EXPECT_EQ(ids_of({"c/f64/cpu-fast"}), "c/f64/cpu-fast");
}

TEST(OwnCode, SaysHowOftenAndOnWhichKindsOfPairsItIsWrong) {
  const CampaignCounts counts = counts_of(summary_of_mine());
  const std::size_t lane = own_lanes(counts).at(0);
  EXPECT_EQ(wrong_words(counts, lane),
            "mine/f32/cpu is wrong on 34 (1.7 %, 95 % interval 1.21 % to 2.37 %) of 2,000 pairs: 2 false positives, 31 "
            "false negatives, 1 crashed.");
  EXPECT_EQ(wrong_by_kind(counts, lane),
            "By group of strata: general 2 of 1,000 (0.2 %), coplanar 32 of 1,000 (3.2 %).");
  EXPECT_EQ(other_builds(counts, lane), "Other builds: f32/cpu-fma wrong on 40, differs on 9.");
}

TEST(OwnCode, WithoutErrorsSaysHowMuchTheDecidedPairsProve) {
  const auto words = [](const analysis::LaneCounts& counts) {
    return wrong_words(counts_of(summary_of({"mine/f32/cpu"}, {"uniform"}, counts)), 0);
  };
  EXPECT_EQ(words({0, 0, 0, 0}),
            "mine/f32/cpu is wrong on none of the 1,000 pairs that it decides: with 95 % confidence it errs on fewer "
            "than 0.3 % of such pairs.");
  EXPECT_EQ(words({0, 0, 900, 0}),
            "mine/f32/cpu is wrong on none of the 100 pairs that it decides: with 95 % confidence it errs on fewer "
            "than 2.96 % of such pairs. It declines 900 pairs.");
  CampaignCounts with_convention = counts_of(summary_of({"mine/f32/cpu"}, {"uniform"}, {0, 0, 0, 0}));
  with_convention.total.lanes[0].by_convention = 100;  // the code decides these pairs too
  EXPECT_EQ(wrong_words(with_convention, 0),
            "mine/f32/cpu is wrong on none of 1,000 pairs. It differs or declines on 100 pairs for which its "
            "convention promises nothing.");
  with_convention.total.lanes[0].declined = 20;
  EXPECT_EQ(wrong_words(with_convention, 0),
            "mine/f32/cpu is wrong on none of 1,000 pairs. It declines 20 pairs that its convention covers. It differs "
            "or declines on 100 pairs for which its convention promises nothing.");
  EXPECT_EQ(words({0, 0, 1000, 0}), "mine/f32/cpu decides none of 1,000 pairs. It declines 1,000 pairs.");
  EXPECT_EQ(other_builds(counts_of(summary_of({"mine/f32/cpu"}, {"uniform"}, {0, 0, 0, 0})), 0), "");
}

TEST(OwnCode, CrashesComeFirstThenItsOwnMistakesThenRoundingThenDegenerateInput) {
  const Json kinds = {kind_of("mine", "degenerate input", "degenerate", 900),
                      kind_of("mine", "rounding", "general", 500), kind_of("other", "logic", "general", 400),
                      kind_of("mine", "logic", "coplanar", 30), kind_of("mine", "crash", "degenerate", 2)};
  std::string causes;
  const CampaignCounts counts = counts_of(summary_of_mine());
  const ReportLane& lane = counts.lanes[own_lanes(counts).at(0)];
  for (const Json& kind : first_kinds(kinds, lane, 3)) causes += kind["cause"].get<std::string>() + ' ';
  EXPECT_EQ(causes, "crash logic rounding ");
  Json of_another_build = kinds;
  of_another_build[4]["lanes"] = {"mine/f32/cpu-fma"};
  EXPECT_EQ(first_kinds(of_another_build, lane, 1)[0]["cause"], "logic");
  EXPECT_TRUE(first_kinds(nullptr, lane, 3).empty());
  EXPECT_EQ(kind_title(kinds[3], 1500), "30 coplanar pairs (2.00 %), all false negatives: logic");
  EXPECT_EQ(kind_title(kinds[3], 45600), "30 coplanar pairs (0.066 %), all false negatives: logic");
  EXPECT_EQ(kind_title(kinds[4], 100), "2 degenerate pairs (2.00 %): crash");
  EXPECT_TRUE(names(kinds_heading(counts, own_lanes(counts).at(0), 3, 7, 1500),
                    {"3 of 7 kinds", "1,500 pairs", "some build", "signature"}));
  const CampaignCounts alone = counts_of(summary_of({"mine/f32/cpu"}, {"uniform"}, {1, 0, 0, 0}));
  EXPECT_FALSE(names(kinds_heading(alone, 0, 1, 1, 1), {"some build"}));
}

TEST(OwnCode, TheErrorsOfAKindAreThoseOfItsPairs) {
  Json kind = kind_of("mine", "logic", "general", 1200);
  EXPECT_EQ(errors_words(kind), "all false negatives");
  kind["intersecting"] = 1;
  EXPECT_EQ(errors_words(kind), "1,199 false positives, 1 false negative");
  kind["intersecting"] = 0;
  EXPECT_EQ(errors_words(kind), "all false positives");
  kind["pairs"] = 1;
  EXPECT_EQ(errors_words(kind), "a false positive");
  kind["cause"] = "unstable";
  EXPECT_EQ(errors_words(kind), "");
}

Json made_open(Json kind) {
  kind["settled"] = {0, 3};
  kind["simplest"]["sentences"] = {"mine/f32 (cpu) says disjoint: not settled: perhaps so"};
  return kind;
}

TEST(OwnCode, CausesThatAreNotSettledAreRankedWithRounding) {
  const CampaignCounts counts = counts_of(summary_of_mine());
  const ReportLane& lane = counts.lanes[own_lanes(counts).at(0)];
  const Json kinds = {kind_of("mine", "rounding", "general", 500), made_open(kind_of("mine", "logic", "contained", 20)),
                      kind_of("mine", "order-dependent", "general", 10)};
  const std::vector<Json> first = first_kinds(kinds, lane, 3);
  ASSERT_EQ(first.size(), 3u);
  EXPECT_EQ(kind_title(first[0], 530), "10 general pairs (1.89 %), all false negatives: order-dependent");
  EXPECT_EQ(kind_title(first[1], 530), "500 general pairs (94.3 %), all false negatives: rounding");
  EXPECT_EQ(kind_title(first[2], 530), "20 contained pairs (3.77 %), all false negatives: perhaps logic");
  const Json rare = {kind_of("mine", "rounding", "general", 5000), kind_of("mine", "logic", "general", 10)};
  EXPECT_EQ(first_kinds(rare, lane, 1)[0]["cause"], "rounding");
}

TEST(OwnCode, AKindsSentenceLeavesTheLanesOut) {
  Json kind = kind_of("mine", "logic", "general", 1);
  EXPECT_EQ(kind_sentence(kind, "mine/f32/cpu"), "mine says disjoint.");
  kind["simplest"]["sentences"] = {"mine/f32 (cpu, cpu-fma) says disjoint, but (so) says nobody."};
  EXPECT_EQ(kind_sentence(kind, "mine/f32/cpu"), "It says disjoint, but (so) says nobody.");
  EXPECT_EQ(kind_sentence(kind, "mine/f64/cpu"), "mine/f32 (cpu, cpu-fma) says disjoint, but (so) says nobody.");
  kind["simplest"]["sentences"] = {
      "mine/f32 (cpu) says intersects, but they are (8 ulps of the largest coordinate) apart."};
  EXPECT_EQ(kind_sentence(kind, "mine/f32/cpu"), "It says intersects, but they are (8 ulps) apart.");
}

TEST(OwnCode, APairOnALineHasTheSameBits) {
  const AnyPair pair = pair_of_kind(kind_of("mine", "logic", "general", 1));
  EXPECT_EQ(pair_on_a_line(pair), "0 0 0  1 0 0  0 1 0   0.1 0 0  1 0 0  0 1 -0.125");
  DoublePair doubles = pair.doubles;
  doubles.b[0].x = 0.1;
  EXPECT_EQ(pair_on_a_line(doubles), pair_on_a_line(pair));  // each as its own type prints it
}

TEST(OwnCode, AnEpsilonIsNamedOnlyIfAFailureShowsIt) {
  Json summary = summary_of_mine();
  summary["strata"]["uniform"]["margins"] = {
      {"+2^0", {{"pairs", 300}, {"wrong", {{"mine/f32/cpu", 2}}}, {"differs_from_cpu", Json::object()}}},
      {"+2^4", {{"pairs", 500}, {"wrong", Json::object()}, {"differs_from_cpu", Json::object()}}}};
  const CampaignCounts counts = counts_of(summary);
  const std::size_t lane = own_lanes(counts).at(0);
  const std::string none = epsilon_words(counts, lane, Json{kind_of("mine", "logic", "general", 7)});
  EXPECT_TRUE(names(none, {"no failure", "absolute epsilon", "none of the 500", "2^1 ulps apart"})) << none;
  const std::string not_named =
      epsilon_words(counts, lane, Json{kind_of("mine", "logic", "general", 7)}, "1e-6f at mine.cpp:9");
  EXPECT_TRUE(names(not_named, {"no failure", "such as your 1e-6f at mine.cpp:9"})) << not_named;
  const Json kind = kind_of("mine", "absolute epsilon", "general", 7);
  const Json kinds = {kind_of("other", "absolute epsilon", "general", 100), kind};
  const std::string some = epsilon_words(counts, lane, kinds, "1e-6f at mine.cpp:9");
  EXPECT_TRUE(
      names(some, {"7 wrong pairs, judging by one pair of each signature, an absolute epsilon or another fixed number",
                   "your 1e-6f at mine.cpp:9", "relative"}))
      << some;
  EXPECT_EQ(some.find("ulps apart"), some.npos) << "of other sizes it fails at other distances";
  Json partly = kinds;
  partly[1]["settled"] = {1, 3};
  const std::string for_some = epsilon_words(counts, lane, partly);
  EXPECT_TRUE(names(for_some, {"7 wrong pairs", "decides, on some of them perhaps", "relative"})) << for_some;
  const std::string open = epsilon_words(counts, lane, Json{made_open(kind)});
  EXPECT_TRUE(names(
      open, {"judging by one pair of each signature, an absolute epsilon or another fixed number perhaps decides"}))
      << open;
  EXPECT_EQ(open.find("relative"), open.npos);
  Json of_another_build = kind;
  of_another_build["lanes"] = {"mine/f32/cpu-fma"};
  EXPECT_EQ(epsilon_words(counts, lane, Json{of_another_build}), none);
}

TEST(OwnCode, AReportsAnswerBeginsWithIt) {
  const CampaignCounts counts = counts_of(summary_of_mine());
  const auto said = answer(counts, nullptr, Json{kind_of("mine", "logic", "coplanar", 31)});
  ASSERT_GE(said.size(), 5u);
  EXPECT_TRUE(names(said[0], {"mine/f32/cpu is wrong on 34"})) << said[0];
  EXPECT_TRUE(names(said[1], {"general 2 of 1,000", "coplanar 32 of 1,000"})) << said[1];
  EXPECT_TRUE(names(said[2], {"cases/logic.pairs", "mine says disjoint."})) << said[2];
  EXPECT_TRUE(names(said[3], {"Epsilon"})) << said[3];
  EXPECT_TRUE(names(said[4], {"Use exact/f32/cpu"})) << said[4];
}

TEST(OwnCode, TheScreenCutsSentencesToKeepItsLength) {
  std::string longer;
  for (int i = 0; i < 200; ++i) longer += "word ";
  const std::vector<ScreenFailure> failures(3, {"30 pairs", "0 0 0  1 0 0", longer});
  const std::string text = one_screen({"before"}, failures, {"after"}, {}, 20);
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 20);
  EXPECT_TRUE(text.starts_with("before\n1. 30 pairs\n   0 0 0  1 0 0\n   word ")) << text;
  EXPECT_TRUE(text.ends_with(" …\nafter\n")) << text;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(width_of(line), 80) << line;
  EXPECT_EQ(one_screen({}, {{"t", "p", "short"}}, {}, {}, 20), "1. t\n   p\n   short\n");
  EXPECT_EQ(one_screen({}, {{"t", "0.125 0.25  0.5 1", "s"}}, {}, {14, false}, 20),
            "1. t\n   0.125 0.25\n   0.5 1\n   s\n");
}

}  // namespace
}  // namespace graze::reports
