// SPDX-License-Identifier: Apache-2.0
// Tests the minimiser on foreign code, whose causes of failure are found with experiments.
#include <gtest/gtest.h>

#include "analysis/experiments.h"
#include "analysis/foreign_testing.h"
#include "core/relation_of.h"
#include "fuzz/minimise/minimise.h"

namespace graze::fuzz {
namespace {

Verdict opposite_of_truth(const Pair& pair) {
  return relation_of(pair).verdict == Verdict::disjoint ? Verdict::intersects : Verdict::disjoint;
}

// Experiments are expensive, so a search that ends at once must make only one experiment.
TEST(MinimiseForeignCode, FindsTheFirstCauseOnce) {
  static analysis::Stranger code(opposite_of_truth);
  static const AlgorithmInfo info{"always_wrong", "test", "", "", "", false};
  const Lane lane{
      "always_wrong/f32/cpu", &info, Scalar::f32, Variant::cpu, "", {}, -1, code, false, false, true, 0, ""};
  const Pair pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}};
  const Relation truth = relation_of(pair);
  const Failure failure{truth, analysis::nesting_of(pair, truth), {&lane}, {lane.decide}, {Verdict::disjoint}};
  const analysis::Experiment one = analysis::experiment(lane, Verdict::disjoint, pair, truth.verdict);
  EXPECT_TRUE(one.settled);
  EXPECT_EQ(code.asked, static_cast<std::size_t>(one.asked));
  EXPECT_GT(one.asked, 100);
  const Minimised known{.pair = pair,
                        .one_minimal = true,
                        .single_moves = 7,
                        .first_cause = one.cause,
                        .reason = {one.cause, true},
                        .worst = pair};
  code.asked = 0;
  const Minimised found = minimise(failure, pair, {&known, 1});
  EXPECT_EQ(found.single_moves, 7u);
  EXPECT_EQ(found.reason.cause, one.cause);
  EXPECT_EQ(code.asked, 1u + static_cast<std::size_t>(one.asked));
}

}  // namespace
}  // namespace graze::fuzz
