// SPDX-License-Identifier: Apache-2.0
// Tests the minimiser on foreign code, whose causes are found with experiments.
#include <gtest/gtest.h>

#include <algorithm>

#include "analysis/experiments.h"
#include "core/relation_of.h"
#include "fuzz/minimise/minimise.h"

namespace graze::fuzz {
namespace {

// This code is always wrong. It counts the pairs that it gets.
class Wrong : public ForeignCode {
 public:
  void decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) override {
    std::fill_n(intersects, (count + 63) / 64, 0);
    std::fill_n(declined, (count + 63) / 64, 0);
    asked += static_cast<int>(count);
    for (std::size_t i = 0; i < count; ++i)
      intersects[i / 64] |= std::uint64_t{relation_of(pairs[i]).verdict == Verdict::disjoint} << i % 64;
  }
  Verdict failure(const Pair&) override { return Verdict::crashed; }
  int asked = 0;
};

// An experiment is expensive. If the search ends at once, only one experiment is made.
TEST(MinimiseForeignCode, FindsTheFirstCauseOnce) {
  static Wrong code;
  static const AlgorithmInfo info{"always_wrong", "test", "", "", "", false};
  const Lane lane{
      "always_wrong/f32/cpu", &info, Scalar::f32, Variant::cpu, "", {}, -1, code, false, false, true, 0, ""};
  const Pair pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}};
  const Relation truth = relation_of(pair);
  const Failure failure{truth, analysis::nesting_of(pair, truth), {&lane}, {lane.decide}, {Verdict::disjoint}};
  const analysis::Experiment one = analysis::experiment(lane, Verdict::disjoint, pair, truth.verdict);
  EXPECT_TRUE(one.settled);
  EXPECT_EQ(code.asked, one.asked);
  EXPECT_GT(one.asked, 100);
  const Minimised known{
      .pair = pair, .one_minimal = true, .single_moves = 7, .reason = {one.cause, true}, .worst = pair};
  code.asked = 0;
  const Minimised found = minimise(failure, pair, {&known, 1});
  EXPECT_EQ(found.single_moves, 7u);
  EXPECT_EQ(found.reason.cause, one.cause);
  EXPECT_EQ(code.asked, 1 + one.asked);
}

}  // namespace
}  // namespace graze::fuzz
