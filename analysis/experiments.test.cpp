// SPDX-License-Identifier: Apache-2.0
// Tests the causes that experiments find. Published algorithms run as foreign code, and their causes are compared with
// those found from their steps. Other code has planted faults.
#include "analysis/experiments.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <map>

#include "analysis/convention.h"
#include "analysis/foreign_testing.h"
#include "analysis/neighbours.h"
#include "analysis/scales.h"
#include "analysis/signature.h"
#include "core/algorithms/moller_1997.h"
#include "core/exact/exact.h"
#include "core/relation_of.h"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

struct Subject {
  AlgorithmInfo info;
  std::string id;
  std::deque<Stranger> code;
};

std::deque<Subject>& subjects() {
  static std::deque<Subject> all;
  return all;
}

// Adds a lane of the subject, and the subject if it does not exist.
const Lane& add_lane(const std::string& subject, Scalar scalar, Variant variant, Stranger::Function function,
                     unsigned outside = 0, Stranger::OnDoubles on_doubles = nullptr) {
  auto found = std::find_if(subjects().begin(), subjects().end(), [&](const Subject& s) { return s.id == subject; });
  if (found == subjects().end()) {
    Subject& made = subjects().emplace_back();
    made.id = subject;
    made.info = {made.id, "test", "", "", "", false};
    found = std::prev(subjects().end());
  }
  Stranger& code = found->code.emplace_back(std::move(function), std::move(on_doubles));
  add_lanes({{"", &found->info, scalar, variant, "", {}, -1, code, false, false, true, outside, ""}});
  return lanes().back();
}

// Like add_lane, but for a function that takes pairs of both types.
template <class Decide>
const Lane& add_lane_of_both(const std::string& subject, Scalar scalar, Variant variant, Decide decide) {
  return scalar == Scalar::f32 ? add_lane(subject, scalar, variant, decide)
                               : add_lane(subject, scalar, variant, decide, 0, decide);
}

template <class Real>
Verdict truth_of(const BasicPair<Real>& pair) {
  return exact::intersects(&pair.a[0].x, &pair.b[0].x) ? Verdict::intersects : Verdict::disjoint;
}
Verdict opposite(Verdict verdict) { return verdict == Verdict::intersects ? Verdict::disjoint : Verdict::intersects; }

std::size_t asked() {
  std::size_t sum = 0;
  for (const Subject& subject : subjects()) {
    for (const Stranger& code : subject.code) sum += code.asked;
  }
  return sum;
}

template <class Real>
bool is_degenerate(const BasicPair<Real>& pair) {
  const Relation r = relation_of(pair);
  return r.hulls.dimension_a < 2 || r.hulls.dimension_b < 2;
}

std::uint64_t strata_of(PairTypes types) {
  return types == PairTypes::f32 ? strata::kStrataCount : strata::kDoubleStrataCount;
}

// Whether the causes agree. Experiments divide `logic` further.
bool agree(Cause by_steps, Cause by_experiment) {
  if (by_steps == Cause::logic)
    return by_experiment == Cause::logic || by_experiment == Cause::degenerate_input ||
           by_experiment == Cause::order_dependent;
  return by_steps == by_experiment;
}

// Compares the causes that experiments find for published algorithms with the causes from their steps.
struct Compared {
  std::map<std::pair<Cause, Cause>, int> settled;  // by steps, by experiment
  std::map<Cause, int> by_steps, open;
  std::map<Cause, std::array<int, 2>> unsettled;  // equal, different
  int alike = 0;

  void print() const {
    for (const auto& [causes, count] : settled)
      fmt::print("{} by steps, {} by experiment: {}\n", name(causes.first), name(causes.second), count);
    for (const auto& [cause, count] : by_steps) {
      const auto of = [cause = cause](const auto& map) {
        return map.contains(cause) ? map.at(cause) : decltype(map.at(cause)){};
      };
      fmt::print("{} by steps: {} of {} not settled by experiment, {} of these agree\n", name(cause), of(open), count,
                 of(unsettled)[0]);
    }
    fmt::print("settled with equal causes: {}\n", alike);
  }
};

Compared compared(std::span<const strata::PairSource> sources) {
  static const std::vector<std::pair<const Lane*, const Lane*>> both = [] {
    const std::vector<Lane> published(published_lanes().begin(), published_lanes().end());
    std::vector<std::pair<const Lane*, const Lane*>> lanes;
    for (const Lane& lane : published) {
      if (lane.is_cuda() || !runs_on_this_cpu(lane)) continue;
      lanes.emplace_back(find_lane(lane.id), &add_lane_of_both("stranger_" + std::string(lane.info->id), lane.scalar,
                                                               lane.variant, [block = lane.decide](const auto& pair) {
                                                                 return decide_one(block, pair);
                                                               }));
    }
    return lanes;
  }();
  Compared result;
  const auto compare = [&](const AnyPair& pair, const std::string& place) {
    const Verdict truth = visit(pair, [](const auto& own) { return truth_of(own); });
    for (const auto& [own, foreign] : both) {
      if (!pair.floats && own->scalar == Scalar::f32) continue;  // this lane decides the pair as float32 stores it
      const std::vector<LaneExplanation> steps = accounts(pair, truth, {&own, 1});
      if (steps.empty() || (steps[0].settled != Settled::yes && steps[0].cause != Cause::fast_math)) continue;
      const std::vector<LaneExplanation> found = accounts(pair, truth, {&foreign, 1});
      ASSERT_EQ(found.size(), 1u);
      EXPECT_EQ(cause_of(*foreign, pair, truth), found[0].cause);
      EXPECT_EQ(found[0].verdict, steps[0].verdict);
      ++result.by_steps[steps[0].cause];
      if (found[0].settled != Settled::yes) {
        ++result.open[steps[0].cause];
        ++result.unsettled[steps[0].cause][agree(steps[0].cause, found[0].cause) ? 0 : 1];
        continue;
      }
      ++result.settled[{steps[0].cause, found[0].cause}];
      ++result.alike;
      EXPECT_TRUE(agree(steps[0].cause, found[0].cause))
          << fmt::format("{} {}: {} by steps, {} by experiment: {}\n", own->id, place, name(steps[0].cause),
                         name(found[0].cause), found[0].experiment);
    }
  };
  for (const strata::PairSource& source : sources) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) compare(source.any_pair(i), fmt::format("{}:33:{}", source.id, i));
  }
  result.print();
  return result;
}

TEST(Experiments, AgreeWithTheStepsOfThePublishedAlgorithms) {
  Compared found = compared(strata::stratum_sources(33, 40 * strata_of(PairTypes::f32), {}));
  for (const Cause cause :
       {Cause::rounding, Cause::contraction, Cause::fast_math, Cause::overflow, Cause::underflow, Cause::logic}) {
    const int of_cause = found.settled[{cause, cause}];
    EXPECT_GT(of_cause, 10) << name(cause);
  }
  EXPECT_GT(found.alike, 1100);
}

// For doubles there is no wider arithmetic to show that rounding or the exponents are to blame.
TEST(Experiments, AgreeWithTheStepsOnDoubles) {
  Compared found = compared(strata::stratum_sources(33, 40 * strata_of(PairTypes::f64), {}, PairTypes::f64));
  for (const Cause cause : {Cause::contraction, Cause::fast_math, Cause::logic}) {
    const int of_cause = found.settled[{cause, cause}];
    EXPECT_GT(of_cause, 10) << name(cause);
  }
  for (const Cause cause : {Cause::rounding, Cause::overflow, Cause::underflow}) {
    const int of_cause = found.settled[{cause, cause}];
    EXPECT_EQ(of_cause, 0) << name(cause);
    EXPECT_GT(found.by_steps[cause], 50) << name(cause);
    EXPECT_GT(found.unsettled[cause][0], 30) << name(cause);
  }
}

// Draws small integers, with zeros and repeated coordinates, so that many pairs touch or are coplanar.
Pair integers(std::uint32_t& state, int largest) {
  Pair pair;
  for (int i = 0; i < kCoordinates; ++i) {
    state = state * 1664525u + 1013904223u;
    const auto draw = static_cast<int>(state >> 16);
    coordinates(pair)[i] =
        draw % 5 == 0 && i >= 3 ? coordinates(pair)[i - 3] : static_cast<float>(draw / 8 % (2 * largest + 1) - largest);
  }
  return pair;
}

// If small integers show logic as the cause, the steps show logic too, except for interval_overlap, whose rounded
// quotients separate touching intervals in either scalar, in all orders and at all multiples.
TEST(Experiments, SmallIntegersShowNoRoundingAsLogic) {
  for (const bool with_doubles : {true, false}) {
    std::vector<std::pair<const Lane*, const Lane*>> both;
    for (const Lane& lane : std::vector<Lane>(published_lanes().begin(), published_lanes().end())) {
      if (lane.variant != Variant::cpu || (lane.scalar == Scalar::f64 && !with_doubles)) continue;
      const DecideBlock block = lane.decide;
      const std::string subject = (with_doubles ? "both_" : "floats_") + std::string(lane.info->id);
      const Lane& foreign =
          add_lane(subject, lane.scalar, lane.variant, [block](const Pair& pair) { return decide_one(block, pair); });
      if (lane.scalar == Scalar::f32) both.emplace_back(find_lane(lane.id), &foreign);
    }
    std::map<Cause, int> settled;
    int rounding = 0, apart = 0, all = 0;
    std::uint32_t state = 1;
    for (int i = 0; i < 20000; ++i) {
      const Pair pair = integers(state, 1 + i % 12);
      const Verdict truth = truth_of(pair);
      for (const auto& [own, foreign] : both) {
        const std::vector<LaneExplanation> steps = accounts(pair, truth, {&own, 1});
        if (steps.empty() || steps[0].settled != Settled::yes) continue;
        const Experiment found = experiment(*foreign, steps[0].verdict, pair, truth);
        rounding += steps[0].cause == Cause::rounding;
        if (!found.settled) continue;
        EXPECT_TRUE(agree(steps[0].cause, found.cause) || own->info->id == "interval_overlap")
            << own->id << ' ' << i << ": " << name(steps[0].cause) << " by steps, " << name(found.cause)
            << " by experiment: " << found.evidence;
        apart += !agree(steps[0].cause, found.cause);
        ++all;
        ++settled[found.cause];
      }
    }
    for (const auto& [cause, count] : settled) fmt::print("on small integers {}: {}\n", name(cause), count);
    fmt::print("rounding by steps {}; settled {}, of which {} by another cause\n", rounding, all, apart);
    EXPECT_LE(apart * 500, all);
    EXPECT_GT(rounding, 100);
    EXPECT_GT(settled[Cause::degenerate_input] + settled[Cause::order_dependent] + settled[Cause::logic], 1000);
  }
}

// Calls `act` for the first pairs of each stratum that `chosen` accepts and on which the lane is wrong.
template <class Chosen>
void for_each_wrong(const Lane& lane, const Chosen& chosen, const std::function<void(const Experiment&)>& act,
                    PairTypes types = PairTypes::f32) {
  int wrong = 0;
  for (const strata::PairSource& source : strata::stratum_sources(31, 60 * strata_of(types), {}, types)) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) {
      visit(source.any_pair(i), [&](const auto& pair) {
        const Verdict truth = truth_of(pair), verdict = decide_lane(lane, pair);
        if (verdict == truth || !chosen(pair)) return;
        SCOPED_TRACE(fmt::format("{} {}:31:{}", lane.id, source.id, i));
        const std::size_t before = asked();
        const Experiment found = experiment(lane, verdict, pair, truth);
        EXPECT_EQ(asked() - before, static_cast<std::size_t>(found.asked));
        EXPECT_LE(found.asked, kMostAsked);
        act(found);
        ++wrong;
      });
    }
  }
  EXPECT_GT(wrong, 20) << lane.id;
}

struct Epsilon : ExactZero {
  template <class Real>
  Real snap(Site, Real x, const std::source_location& = std::source_location::current()) const {
    return x < Real(1e-6) && x > Real(-1e-6) ? Real(0) : x;
  }
};

template <class Real, class Policy>
struct Moller {
  template <class Coordinate>
  Verdict operator()(const BasicPair<Coordinate>& pair) const {
    Vec3<Real> a[3], b[3];
    for (int i = 0; i < 9; ++i) {
      (&a[0].x)[i] = static_cast<Real>((&pair.a[0].x)[i]);
      (&b[0].x)[i] = static_cast<Real>((&pair.b[0].x)[i]);
    }
    return Moller1997::decide(a, b, Policy{});
  }
};

TEST(Experiments, FindAnAbsoluteEpsilon) {
  const Lane* f64 = &add_lane_of_both("epsilon", Scalar::f64, Variant::cpu, Moller<double, Epsilon>());
  const auto right_without = [](const auto& pair) { return Moller<double, ExactZero>()(pair) == truth_of(pair); };
  for (const PairTypes types : {PairTypes::f32, PairTypes::f64}) {
    int settled = 0, alike = 0, all = 0;
    for_each_wrong(
        *f64, right_without,
        [&](const Experiment& found) {
          EXPECT_TRUE(found.cause == Cause::absolute_epsilon || (types == PairTypes::f64 && !found.settled))
              << name(found.cause) << found.evidence;
          settled += found.settled;
          alike += found.cause == Cause::absolute_epsilon;
          ++all;
        },
        types);
    fmt::print("epsilon in float64: {} of {} settled\n", settled, all);
    EXPECT_GE(alike + 2, all);
    EXPECT_GT(settled, all * 3 / 4);
  }
  const Lane* f32 = &add_lane("epsilon_float", Scalar::f32, Variant::cpu, Moller<float, Epsilon>());
  std::map<Cause, int> causes;
  for_each_wrong(
      *f32, [](const auto& pair) { return Moller<float, ExactZero>()(pair) == truth_of(pair); },
      [&](const Experiment& found) {
        EXPECT_TRUE(found.cause == Cause::absolute_epsilon || !found.settled) << name(found.cause) << found.evidence;
        ++causes[found.cause];
      });
  for (const auto& [cause, count] : causes) fmt::print("epsilon in float32: {} {}\n", name(cause), count);
  EXPECT_GT(causes[Cause::absolute_epsilon], 70);
}

TEST(Experiments, FindWhatErrsOnDegenerateInput) {
  const auto decide = [](const auto& pair) { return is_degenerate(pair) ? opposite(truth_of(pair)) : truth_of(pair); };
  const Lane &f32 = add_lane("degenerate", Scalar::f32, Variant::cpu, decide),
             &f64 = add_lane_of_both("degenerate_doubles", Scalar::f64, Variant::cpu, decide);
  const auto expect_degenerate = [](const Experiment& found) {
    EXPECT_EQ(found.cause, Cause::degenerate_input) << found.evidence;
  };
  const auto any = [](const auto&) { return true; };
  for_each_wrong(f32, any, expect_degenerate);
  for_each_wrong(f64, any, expect_degenerate, PairTypes::f64);
  const Pair small{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{1, -1, 0}, {1, 1, 0}, {1, 2, 1}}};
  for (const Experiment& found : {experiment(f32, decide_lane(f32, small), small, truth_of(small)),
                                  experiment(f64, decide_lane(f64, small), in_doubles(small), truth_of(small))}) {
    expect_degenerate(found);
    EXPECT_TRUE(found.settled) << found.evidence;
  }
}

TEST(Experiments, FindWhatDependsOnOrder) {
  const auto decide = [](const auto& pair) {
    const auto square = [](const auto& v) { return double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z; };
    return square(pair.a[0]) > square(pair.a[1]) ? opposite(truth_of(pair)) : truth_of(pair);
  };
  const Lane &f32 = add_lane("order", Scalar::f32, Variant::cpu, decide),
             &f64 = add_lane_of_both("order_doubles", Scalar::f64, Variant::cpu, decide);
  for (const auto& [lane, types] : {std::pair{&f32, PairTypes::f32}, {&f64, PairTypes::f64}}) {
    int order = 0, all = 0;
    for_each_wrong(
        *lane, [](const auto& pair) { return !is_degenerate(pair); },
        [&](const Experiment& found) {
          order += found.cause == Cause::order_dependent;
          EXPECT_TRUE(!found.settled || found.cause == Cause::order_dependent) << name(found.cause) << found.evidence;
          ++all;
        },
        types);
    fmt::print("order: {} of {}\n", order, all);
  }
  const Pair small{{{2, 0, 0}, {1, 0, 0}, {0, 2, 0}}, {{1, 1, -1}, {1, 0, 1}, {2, 2, 1}}};
  for (const Experiment& found : {experiment(f32, decide_lane(f32, small), small, truth_of(small)),
                                  experiment(f64, decide_lane(f64, small), in_doubles(small), truth_of(small))}) {
    EXPECT_EQ(found.cause, Cause::order_dependent) << found.evidence;
    EXPECT_TRUE(found.settled) << found.evidence;
  }
}

// Code that is wrong in all orders on small integers has a logic error, with or without an epsilon. If a cause is not
// settled, its evidence names two experiments.
TEST(Experiments, FindLogicOnSmallIntegers) {
  const auto contained = [](float epsilon) {
    return [epsilon](const Pair& pair) {
      const Relation r = relation_of(pair);
      float size = 0;
      for (int i = 0; i < kCoordinates; ++i) size = std::max(size, std::fabs(coordinates(pair)[i]));
      if (size <= epsilon) return Verdict::intersects;
      return r.hulls.coplanar && nesting_of(pair, r) != Nesting::none ? Verdict::disjoint : r.verdict;
    };
  };
  const Pair inside{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{1, 1, 0}, {3, 1, 0}, {1, 3, 0}}};
  for (const float epsilon : {0.0f, 1e-6f}) {
    const Lane& lane = add_lane(fmt::format("contained_{}", epsilon), Scalar::f32, Variant::cpu, contained(epsilon));
    const Experiment found = experiment(lane, decide_lane(lane, inside), inside, truth_of(inside));
    EXPECT_EQ(found.cause, Cause::logic) << found.evidence;
    EXPECT_TRUE(found.settled) << found.evidence;
    EXPECT_NE(found.evidence.find("in all 72 orders"), std::string::npos) << found.evidence;
    Pair fine = inside;
    fine.b[1].x = std::nextafter(3.0f, 4.0f);
    const Experiment open = experiment(lane, decide_lane(lane, fine), fine, truth_of(fine));
    EXPECT_FALSE(open.settled) << open.evidence;
    EXPECT_NE(open.evidence.find("to settle it, try the pair in small integers (graze minimize) or the same code in "
                                 "doubles"),
              std::string::npos)
        << open.evidence;
  }
}

TEST(Experiments, FindOverflowAndUnderflow) {
  // This code is right, unless the product of four large differences overflows or underflows.
  const auto product = [](const Pair& pair) {
    float most = 0;
    for (int i = 0; i < 18; ++i) most = std::max(most, std::fabs((&pair.a[0].x)[i] - (&pair.a[0].x)[i % 3]));
    return most * most * most * most;
  };
  const Lane& over = add_lane("overflows", Scalar::f32, Variant::cpu, [product](const Pair& pair) {
    return std::isfinite(product(pair)) ? truth_of(pair) : opposite(truth_of(pair));
  });
  add_lane("overflows", Scalar::f64, Variant::cpu, truth_of<float>);
  const Lane& under = add_lane("underflows", Scalar::f32, Variant::cpu, [product](const Pair& pair) {
    return product(pair) >= 0x1p-126f ? truth_of(pair) : opposite(truth_of(pair));
  });
  add_lane("underflows", Scalar::f64, Variant::cpu, truth_of<float>);
  // The same code in doubles, where no wider type can settle the cause.
  const auto product_of_doubles = [](const DoublePair& pair) {
    double most = 0;
    for (int i = 0; i < 18; ++i) most = std::max(most, std::fabs((&pair.a[0].x)[i] - (&pair.a[0].x)[i % 3]));
    return most * most * most * most;
  };
  const Lane& over64 =
      add_lane("overflows_doubles", Scalar::f64, Variant::cpu, truth_of<float>, 0, [=](const DoublePair& pair) {
        return std::isfinite(product_of_doubles(pair)) ? truth_of(pair) : opposite(truth_of(pair));
      });
  const Lane& under64 =
      add_lane("underflows_doubles", Scalar::f64, Variant::cpu, truth_of<float>, 0, [=](const DoublePair& pair) {
        return product_of_doubles(pair) >= 0x1p-1022 ? truth_of(pair) : opposite(truth_of(pair));
      });
  const Pair plain{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}};
  for (const auto& [lane, k, cause] : {std::tuple{&over64, 400, Cause::overflow}, {&under64, -400, Cause::underflow}}) {
    const DoublePair pair = analysis::scaled(in_doubles(plain), k);
    const Experiment found = experiment(*lane, decide_lane(*lane, pair), pair, truth_of(pair));
    EXPECT_EQ(found.cause, cause) << name(found.cause) << ' ' << found.evidence;
    EXPECT_FALSE(found.settled) << found.evidence;
  }
  for (const auto& [lane, k, cause] :
       {std::tuple{&over, 60, Cause::overflow}, {&over, 40, Cause::overflow}, {&under, -60, Cause::underflow}}) {
    Pair pair = plain;
    for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = std::ldexp(coordinates(pair)[i], k);
    const Experiment found = experiment(*lane, decide_lane(*lane, pair), pair, truth_of(pair));
    EXPECT_EQ(found.cause, cause) << name(found.cause) << ' ' << found.evidence;
    EXPECT_TRUE(found.settled) << found.evidence;
  }
}

TEST(Experiments, BlameExponentsOnlyWhereAProductLeavesThem) {
  const auto wrong_where = [](std::string_view id, auto is_wrong_at) -> const Lane& {
    add_lane(std::string(id), Scalar::f64, Variant::cpu, truth_of<float>);
    return add_lane(std::string(id), Scalar::f32, Variant::cpu, [is_wrong_at](const Pair& pair) {
      return is_wrong_at(std::fabs(pair.b[2].x)) ? opposite(truth_of(pair)) : truth_of(pair);
    });
  };
  const Lane& large = wrong_where("wrong_above_16", [](float x) { return x >= 16; });
  const Lane& small = wrong_where("wrong_below_32", [](float x) { return x < 32; });
  // On this pair, few products underflow and none overflows.
  const Pair pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {30.000002f, 3, 1}}};
  for (const Lane* lane : {&large, &small}) {
    const Experiment found = experiment(*lane, decide_lane(*lane, pair), pair, truth_of(pair));
    EXPECT_EQ(found.cause, Cause::rounding) << lane->id << ' ' << name(found.cause) << ' ' << found.evidence;
    EXPECT_FALSE(found.settled) << found.evidence;
  }
}

TEST(Experiments, AFailureIsItsOwnCauseAndAConventionIsNone) {
  const Pair pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 1, 1}, {3, 3, 1}}};  // touching
  for (const auto& [verdict, cause] : {std::pair{Verdict::crashed, Cause::crash},
                                       {Verdict::timed_out, Cause::no_answer},
                                       {Verdict::unstable, Cause::unstable}}) {
    const Lane* lane = &add_lane(
        "fails_" + std::string(name(verdict)), Scalar::f32, Variant::cpu,
        [verdict = verdict](const Pair&) { return verdict; }, kOutsideTouching);
    const Explanation explanation = explain(pair, {&lane, 1});
    ASSERT_EQ(explanation.lanes.size(), 1u);
    EXPECT_EQ(explanation.lanes[0].cause, cause);
    EXPECT_EQ(explanation.lanes[0].settled, Settled::yes);
  }
  const Lane* open = &add_lane(
      "open", Scalar::f32, Variant::cpu, [](const Pair&) { return Verdict::disjoint; }, kOutsideTouching);
  const Explanation explanation = explain(pair, {&open, 1});
  EXPECT_TRUE(explanation.lanes.empty());
  EXPECT_EQ(
      sentences(explanation),
      std::vector<std::string>{"open (f32/cpu) says otherwise, and is not wrong: the pair is not in its contract, "
                               "which leaves out touching pairs."});
}

}  // namespace
}  // namespace graze::analysis
