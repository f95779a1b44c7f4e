// SPDX-License-Identifier: Apache-2.0
#include "reports/sufficient.h"

#include <gtest/gtest.h>

namespace graze::reports {
namespace {

using analysis::TuneResult;

Candidate candidate(const char* lane, Scalar scalar, std::uint64_t wrong, double nanoseconds,
                    TuneResult result = TuneResult::satisfied) {
  analysis::PolicyErrors errors;
  errors.pairs = 100'000;
  errors.false_negative = wrong;
  return {lane,
          scalar,
          result,
          errors,
          analysis::upper_bound(wrong, errors.pairs),
          {nanoseconds - 1, nanoseconds, nanoseconds + 1}};
}

const std::vector<Candidate> kThree = {candidate("a/f32/cpu", Scalar::f32, 20'000, 10, TuneResult::not_satisfiable),
                                       candidate("b/f32/cpu/rel:1", Scalar::f32, 2, 40),
                                       candidate("c/f64/cpu", Scalar::f64, 0, 30)};

TEST(Sufficient, TheCheapestThatKeepsTheRateIsChosen) {
  EXPECT_EQ(cheapest_sufficient(kThree), &kThree[2]);
  EXPECT_EQ(cheapest_sufficient(kThree, Scalar::f32), &kThree[1]);
  EXPECT_EQ(cheapest_sufficient({kThree.data(), 1}), nullptr);
}

TEST(Sufficient, ACheaperLaneIsRecommendedWithItsBound) {
  EXPECT_EQ(
      sufficient_sentences(1e-3, kThree, "exact/f32/cpu", {58, 60, 62}),
      (std::vector<std::string>{
          "Wrong on at most 0.001 of this scene's pairs: use c/f64/cpu, at 95 % confidence wrong on under 3e-05 of "
          "the pairs (0 of 100,000 fresh pairs), 30 ns (29 to 31) a pair.",
          "exact/f32/cpu is never wrong and takes 60 ns (58 to 62).",
          "In f32 the cheapest that suffices is b/f32/cpu/rel:1: at 95 % confidence wrong on under 6.3e-05 of the "
          "pairs (2 of 100,000 fresh pairs), 40 ns (39 to 41)."}));
}

TEST(Sufficient, ExactIsRecommendedWhereNothingIsCheaper) {
  EXPECT_EQ(sufficient_sentences(1e-3, kThree, "exact/f32/cpu", {17, 18, 19})[0],
            "Wrong on at most 0.001 of this scene's pairs: use exact/f32/cpu, never wrong, 18 ns (17 to 19) a pair.");
  EXPECT_TRUE(sufficient_sentences(1e-3, kThree, "exact/f32/cpu", {17, 18, 19})[1].ends_with(
      ", and more expensive at 30 ns (29 to 31)."));
  EXPECT_TRUE(sufficient_sentences(1e-3, kThree, "exact/f32/cpu", {20, 29.5, 31})[1].ends_with(
      ", at 30 ns (29 to 31) not cheaper beyond the spread of the measurements."));
}

TEST(Sufficient, TheLeastWrongIsNamedWhereNoneSuffices) {
  const std::span<const Candidate> one(kThree.data(), 1);
  EXPECT_EQ(sufficient_sentences(1e-3, one, "exact/f32/cpu", {17, 18, 19})[1],
            "No published lane is shown to suffice; the least wrong, a/f32/cpu, is wrong on 20,000 of 100,000 fresh "
            "pairs.");
  const std::vector<Candidate> two(kThree.begin(), kThree.begin() + 2);
  std::vector<Candidate> wrong64 = two;
  wrong64.push_back(candidate("d/f64/cpu", Scalar::f64, 500, 30, TuneResult::not_confirmed));
  EXPECT_EQ(
      sufficient_sentences(1e-3, wrong64, "exact/f32/cpu", {17, 18, 19})[2],
      "No published lane of f64 is shown to suffice; the least wrong, d/f64/cpu, is wrong on 500 of 100,000 fresh "
      "pairs.");
}

}  // namespace
}  // namespace graze::reports
