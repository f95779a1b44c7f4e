// SPDX-License-Identifier: Apache-2.0
// Tests the minimiser's guarantees: a total order, the same failure, no simpler pair one move away, and the same bytes
// each time.
#include "fuzz/minimise/minimise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "core/relation_of.h"
#include "core/simplify/moves.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimised_cases.h"
#include "oracle/truth.h"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

constexpr std::uint64_t kSeed = 5;

const SelectedLanes& under_test() {
  static const SelectedLanes all = select_lanes({}, Executor::twin);
  return all;
}

std::string text(const AnyPair& pair) { return pair_text(pair) + '\n'; }

bool same_bits(const AnyPair& l, const AnyPair& r) { return text(l) == text(r); }

Pair pair_of(std::initializer_list<float> values) {
  Pair pair{};
  std::copy(values.begin(), values.end(), coordinates(pair));
  return pair;
}

struct Case {
  Pair pair;
  Failure failure;
  std::string name;
};

// The first failures of a stratum, at most `most` for each algorithm.
std::vector<Case> cases_of(strata::Stratum stratum, std::size_t most) {
  std::vector<Case> found;
  std::map<std::string_view, std::size_t> of_algorithm;
  for (std::uint64_t index = 0; index < 3000; ++index) {
    const Pair pair = strata::generate(kSeed, stratum, index);
    for (Failure& failure : failures_of(under_test(), pair)) {
      if (++of_algorithm[failure.lanes.front()->info->id] > most) continue;
      const std::string name = std::to_string(index) + " " + std::string(failure.lanes.front()->info->id);
      found.push_back({pair, std::move(failure), name});
    }
  }
  return found;
}

// Each row has a pair, a less simple pair, and the first criterion in which they differ. Criterion 9 compares the
// coordinates.
TEST(Simplicity, ComparesInTheStatedOrder) {
  struct Row {
    Pair simpler, other;
    int criterion;
  };
  const auto with_b = [](std::initializer_list<float> b) {
    Pair pair = pair_of({0, 0, 0, 1, 0, 0, 0, 1, 0});
    std::copy(b.begin(), b.end(), &pair.b[0].x);
    return pair;
  };
  const Pair few = with_b({0, 0, 0, 7, 7, 7, 7, 7, 0}), in_x = pair_of({0, 0, 0, 0, 1, 0, 0, 0, 1}),
             in_space = pair_of({0, 0, 0, 1, 1, 1, 0, 0, 0});
  const Pair in_z = pair_of({0, 0, 0, 1, 0, 0, 0, 1, 0});
  Pair mirrored = few;
  mirrored.b[2].x = -7;
  const Row rows[] = {
      {few, with_b({0, 0, 0, 2, 3, 0, 0, 0, 0}), 1},
      {with_b({0, 0, 0, 999, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 2, 2, 0, 0, 0, 0}), 2},
      {with_b({0, 0, 0, 999, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 1024, 0, 0, 0, 0, 0}), 3},
      {with_b({0, 0, 0, 999, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 0.5, 0, 0, 0, 0, 0}), 3},
      {with_b({0, 0, 0, 64, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 3, 0, 0, 0, 0, 0}), 4},
      {with_b({0, 0, 0, 5, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 10, 0, 0, 0, 0, 0}), 5},
      {with_b({0, 0, 0, 1, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 0, 0, 1, 0, 0, 0}), 6},
      {in_z, in_x, 7},
      {few, mirrored, 8},
      {with_b({0, 0, 0, 5, 0, 0, 0, 0, 0}), with_b({0, 0, 0, 7, 0, 0, 0, 0, 0}), 9},
      {with_b({0, 0, 0, 0, 0, 0, 0, 5, 0}), with_b({0, 0, 0, 0, 5, 0, 0, 0, 0}), 9},
  };
  for (const Row& row : rows) {
    const Simplicity l = simplicity(row.simpler), r = simplicity(row.other);
    EXPECT_LT(l, r) << row.criterion;
    int apart = 1;
    while (apart < 9 && count_of(l, apart) == count_of(r, apart)) ++apart;
    EXPECT_EQ(apart, row.criterion);
  }
  EXPECT_EQ(count_of(simplicity(in_space), 7), 2);
}

// Of any two pairs with different bits, one is simpler, and the relation is transitive.
TEST(Simplicity, IsATotalOrder) {
  std::vector<Pair> pairs;
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::uint64_t index = 0; index < 12; ++index) pairs.push_back(strata::generate(kSeed, row.stratum, index));
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& l, const Pair& r) { return simplicity(l) < simplicity(r); });
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i; j < pairs.size(); ++j) {
      ASSERT_FALSE(simplicity(pairs[j]) < simplicity(pairs[i]));
      ASSERT_EQ(simplicity(pairs[i]) == simplicity(pairs[j]), same_bits(pairs[i], pairs[j]));
      // The faster functions that the minimiser calls must agree with `<`.
      const std::uint64_t l = simplicity_counts(pairs[i]), r = simplicity_counts(pairs[j]);
      ASSERT_EQ(simplicity_counts(pairs[j], l) > l, r > l);
      ASSERT_EQ(simplicity_counts(pairs[i], r), l);  // at most r, because the pairs are sorted
      if (l == r) {
        ASSERT_EQ(simpler_coordinates(pairs[i], pairs[j]), !same_bits(pairs[i], pairs[j]));
        ASSERT_FALSE(simpler_coordinates(pairs[j], pairs[i]));
      }
    }
  }
}

TEST(Simplicity, IsEqualOnlyForTheSameBits) {
  const Pair zero{};
  for (const float other : {-0.0f, 1.0f, -1.0f, 1e-45f, -1e-45f, 3e38f}) {
    for (int i = 0; i < kCoordinates; ++i) {
      Pair pair{};
      coordinates(pair)[i] = other;
      EXPECT_LT(simplicity(zero), simplicity(pair));
      Pair mirrored = pair;
      coordinates(mirrored)[i] *= -1;
      EXPECT_NE(simplicity(mirrored), simplicity(pair));
    }
  }
}

TEST(Simplicity, CountsDistancesOfExponentsDownToSubnormals) {
  Pair pair{};
  for (const auto& [value, distance] :
       {std::pair{1e-45f, 149}, {0x1p-126f, 126}, {0x1p-127f, 127}, {0.75f, 1}, {6.0f, 2}}) {
    pair.b[2].z = value;
    EXPECT_EQ(count_of(simplicity(pair), 5), distance) << value;
  }
}

TEST(Moves, AreFiniteWhateverThePair) {
  const float most = std::numeric_limits<float>::max();
  for (const Pair& pair : {pair_of({most, -most, 1, most, most, 0, 0, 0, 1e-45f, 1, most, 0, 0, -1e-45f, 0, 1, 1, 1}),
                           Pair{}, pair_of({1e-45f, 0, 0, 0, 2e-45f, 0, 0, 0, 1e-38f})}) {
    std::vector<Pair> moved;
    for (int kind = 0; kind < kMoveKinds; ++kind) append_moves(pair, kind, moved);
    EXPECT_GT(moved.size(), 1000u);
    for (const Pair& m : moved) ASSERT_TRUE(is_finite(m)) << text(m);
  }
}

// A float32 pair is as simple as the same pair in doubles, and moves in doubles include moves in float32.
TEST(Simplicity, IsThatOfTheSameNumbersInDoubles) {
  std::size_t reached = 0, of_floats = 0;
  for (const strata::StratumInfo& stratum : strata::kStrata) {
    for (std::uint64_t i = 0; i < 40; ++i) {
      const Pair pair = strata::generate(kSeed, stratum.stratum, i);
      const DoublePair doubles = in_doubles(pair);
      ASSERT_EQ(simplicity(pair), simplicity(doubles)) << text(pair);
      ASSERT_EQ(simplicity_counts(pair), simplicity_counts(doubles));
      if (i > 0) continue;
      std::set<std::string> there;
      std::vector<DoublePair> moved;
      std::vector<Pair> moved_floats;
      for (int kind = 0; kind < kMoveKinds; ++kind) {
        append_moves(doubles, kind, moved);
        append_moves(pair, kind, moved_floats);
      }
      for (const DoublePair& m : moved) there.insert(text(m));
      for (const Pair& m : moved_floats) reached += there.contains(text(in_doubles(m)));
      of_floats += moved_floats.size();
    }
  }
  EXPECT_GT(reached, of_floats / 2);  // the other moves of floats round to float32
  EXPECT_LT(reached, of_floats);
}

class MinimiseStratum : public testing::TestWithParam<strata::StratumInfo> {};

// The oracle confirms the same failure, and the result is at least as simple as the original. No move of any kind
// improves it, and minimising it again changes nothing.
TEST_P(MinimiseStratum, MinimisesToAOneMinimalPairThatFailsAlike) {
  const std::vector<Case> cases = cases_of(GetParam().stratum, 4);
  ASSERT_FALSE(cases.empty());
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Minimised found = minimise(c.failure, c.pair);
    EXPECT_LE(simplicity(found.pair), simplicity(c.pair));

    const oracle::Truth t = oracle::truth(found.pair);
    EXPECT_EQ(t.contact, oracle::gmp_contact(c.pair));
    EXPECT_EQ(oracle::hulls(*found.pair.floats), oracle::hulls(c.pair));
    EXPECT_EQ(std::signbit(t.margin), std::signbit(oracle::truth(c.pair).margin));
    EXPECT_EQ(t.margin == 0, oracle::truth(c.pair).margin == 0);
    for (std::size_t l = 0; l < c.failure.lanes.size(); ++l) {
      std::uint64_t before[2], after[2];
      c.failure.on_host[l](&c.pair, 1, &before[0], &before[1]);
      c.failure.on_host[l](&*found.pair.floats, 1, &after[0], &after[1]);
      EXPECT_EQ(before[0], after[0]) << c.failure.lanes[l]->id;
      EXPECT_EQ(before[1], after[1]) << c.failure.lanes[l]->id;
    }
    EXPECT_NO_THROW(confirm(under_test(), c.failure, found.pair));
    EXPECT_NO_THROW(confirm(under_test(), c.failure, found.worst));
    EXPECT_EQ(std::fabs(oracle::truth(found.worst).margin_ulps), found.worst_ulps);
    EXPECT_GE(found.worst_ulps, std::fabs(oracle::truth(c.pair).margin_ulps));
    EXPECT_GE(found.worst_ulps, std::fabs(t.margin_ulps));

    std::vector<Pair> moved;
    for (int kind = 0; kind < kMoveKinds; ++kind) append_moves(*found.pair.floats, kind, moved);
    std::size_t simpler = 0;
    for (const Pair& m : moved) {
      if (!(simplicity(m) < simplicity(found.pair))) continue;
      ++simpler;
      ASSERT_FALSE(fails_for_reason(c.failure, found.reason, m)) << text(found.pair) << text(m);
    }
    EXPECT_TRUE(found.one_minimal);
    EXPECT_LT(found.moved, kMostMoved / 2);
    const Reason before = reason_of(c.failure, c.pair);
    EXPECT_EQ(found.reason.cause, before.cause);
    EXPECT_TRUE(found.reason == reason_of(c.failure, found.pair));
    EXPECT_TRUE(fails_for_reason(c.failure, before, found.pair));
    EXPECT_LE(found.single_moves, simpler);  // equal results of one kind of move are counted once
    EXPECT_EQ(found.single_moves == 0, simpler == 0);

    const Minimised again = minimise(c.failure, found.pair);
    EXPECT_TRUE(same_bits(again.pair, found.pair));
    EXPECT_EQ(again.single_moves, found.single_moves);
    EXPECT_TRUE(same_bits(minimise(c.failure, c.pair).pair, found.pair));
  }
}

INSTANTIATE_TEST_SUITE_P(Every, MinimiseStratum, testing::ValuesIn(strata::kStrata),
                         [](const auto& row) { return std::string(row.param.id); });

const SelectedLanes& under_test_of_doubles() {
  static const SelectedLanes all = [] {
    SelectedLanes lanes = select_lanes({}, Executor::twin);
    select_for_doubles(lanes);
    return lanes;
  }();
  return all;
}

// On pairs of doubles from every stratum, too, the results are one-minimal pairs of doubles that fail alike.
TEST(MinimiseDoubles, MinimisesToAOneMinimalPairThatFailsAlike) {
  std::map<analysis::Cause, int> causes;
  int minimal = 0, all = 0;
  for (const strata::PairSource& source : strata::stratum_sources(kSeed, 28 * 300, {}, PairTypes::f64)) {
    std::set<std::string_view> of_stratum;  // one failure of each algorithm
    for (std::uint64_t index = 0; index < source.pairs; ++index) {
      const DoublePair pair = source.double_pair(index);
      for (const Failure& failure : failures_of(under_test_of_doubles(), pair)) {
        if (!of_stratum.insert(failure.lanes.front()->info->id).second) continue;
        SCOPED_TRACE(source.id + ' ' + std::to_string(index) + ' ' + std::string(failure.lanes.front()->info->id));
        const Minimised found = minimise(failure, pair);
        ASSERT_FALSE(found.pair.floats);
        ASSERT_FALSE(found.worst.floats);
        const DoublePair& small = found.pair.doubles;
        EXPECT_LE(simplicity(small), simplicity(pair));
        EXPECT_EQ(oracle::truth(small).contact, oracle::gmp_contact(pair));
        EXPECT_EQ(oracle::hulls(small), oracle::hulls(pair));
        EXPECT_NO_THROW(confirm(under_test_of_doubles(), failure, small));
        EXPECT_NO_THROW(confirm(under_test_of_doubles(), failure, found.worst));
        const Reason before = reason_of(failure, pair);
        EXPECT_EQ(found.reason.cause, before.cause);
        EXPECT_TRUE(found.reason == reason_of(failure, small));
        ++causes[before.cause];
        ++all;
        minimal += found.one_minimal;
        if (!found.one_minimal) continue;
        std::vector<DoublePair> moved;
        for (int kind = 0; kind < kMoveKinds; ++kind) append_moves(small, kind, moved);
        for (const DoublePair& m : moved) {
          if (!(simplicity(m) < simplicity(small))) continue;
          ASSERT_FALSE(fails_for_reason(failure, found.reason, m)) << text(small) << text(m);
        }
        EXPECT_TRUE(same_bits(minimise(failure, small).pair, small));
      }
    }
  }
  EXPECT_GT(causes[analysis::Cause::stored], 10);
  EXPECT_GT(causes[analysis::Cause::rounding], 3);
  EXPECT_GT(all, 60);
  EXPECT_GT(minimal, all * 9 / 10);
}

TEST(Minimise, ShrinksWhatFailsOnlyAtTheEndsOfTheRange) {
  // Scales a crossing pair so far down or up that products underflow or overflow in float32.
  for (const float scale : {0x1p-149f, 1e-30f, 1e37f}) {
    Pair pair = pair_of({-1, -1, 0, 3, -1, 0, -1, 3, 0, 0, 0, -1, 0, 0, 1, 1, 1, 2});
    for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] *= scale;
    const std::vector<Failure> failures = failures_of(under_test(), pair);
    ASSERT_FALSE(failures.empty()) << scale;
    for (const Failure& failure : failures) {
      const Minimised found = minimise(failure, pair);
      EXPECT_NO_THROW(confirm(under_test(), failure, found.pair));
      EXPECT_LE(nontrivial_magnitudes(found.pair), nontrivial_magnitudes(pair));
    }
  }
}

// Each shear lowers a coordinate of this pair by only 2, so 620,000 single shears would be needed.
TEST(Minimise, MovesThatHelpAreDoneManyTimesAtOnce) {
  const SelectedLanes one = select_lanes({"projected_sat/f32/cpu"});
  const Pair pair = strata::generate(21, strata::Stratum::mixed_scale, 649);
  const std::vector<Failure> failures = failures_of(one, pair);
  ASSERT_EQ(failures.size(), 1u);
  const Minimised found = minimise(failures.front(), pair);
  EXPECT_TRUE(found.one_minimal);
  EXPECT_LT(found.moved, 200'000u);
  EXPECT_EQ(nontrivial_magnitudes(found.pair), 1);
}

// The search ends within any limit, and its result fails alike and states its own reason.
TEST(Minimise, EndsWithinItsLimit) {
  int stopped = 0;
  for (const auto stratum : {strata::Stratum::near_edge_edge, strata::Stratum::extreme_scale}) {
    for (const Case& c : cases_of(stratum, 2)) {
      SCOPED_TRACE(c.name);
      const Reason before = reason_of(c.failure, c.pair);
      const Minimised whole = minimise(c.failure, c.pair);
      for (std::size_t most = kLeastMoved + 1; most < kLeastMoved + 60'000; most = most + 15'000) {
        const Minimised part = minimise(c.failure, c.pair, {}, most);
        EXPECT_LE(part.moved, most + 2'000);  // the moves of one kind may exceed the limit
        EXPECT_LE(simplicity(part.pair), simplicity(c.pair));
        EXPECT_LE(simplicity(whole.pair), simplicity(part.pair));
        EXPECT_TRUE(fails_for_reason(c.failure, before, part.pair));
        EXPECT_EQ(part.one_minimal, same_bits(part.pair, whole.pair) && part.single_moves == whole.single_moves);
        stopped += !part.one_minimal;
      }
    }
  }
  EXPECT_GT(stopped, 10);
}

// If the search reaches a known result, it returns that result, the pair at which it would end anyway.
TEST(Minimise, EndsWhereAnotherCaseEnded) {
  for (const Case& c : cases_of(strata::Stratum::near_vertex_face, 1)) {
    SCOPED_TRACE(c.name);
    const Minimised first = minimise(c.failure, c.pair);
    const Minimised again = minimise(c.failure, c.pair, {&first, 1});
    EXPECT_TRUE(same_bits(again.pair, first.pair));
    EXPECT_TRUE(again.one_minimal);
    EXPECT_EQ(again.single_moves, first.single_moves);
    EXPECT_LT(again.moved, first.moved);
  }
}

// Rounding failures near the limits of the exponents (2^-75) must not become overflow or underflow as the pair shrinks.
TEST(Minimise, TheCauseStays) {
  std::set<analysis::Cause> seen;
  int out_of_range = 0;
  for (const auto stratum : {strata::Stratum::extreme_scale, strata::Stratum::mixed_scale, strata::Stratum::sliver}) {
    for (const Case& c : cases_of(stratum, 6)) {
      SCOPED_TRACE(c.name);
      const Minimised found = minimise(c.failure, c.pair);
      const Lane* first = &c.failure.first_wrong(c.pair);
      const analysis::Explanation before = analysis::explain(c.pair, {&first, 1}),
                                  after = analysis::explain(found.pair, {&first, 1});
      ASSERT_EQ(before.lanes.size(), 1u);
      ASSERT_EQ(after.lanes.size(), 1u);
      EXPECT_EQ(after.lanes[0].cause, before.lanes[0].cause);
      seen.insert(before.lanes[0].cause);
      out_of_range += !found.reason.in_range;
    }
  }
  EXPECT_GE(seen.size(), 4u);
  EXPECT_GT(out_of_range, 0);
}

// A lane excused by its convention is not the first wrong lane, even if it comes first.
TEST(Minimise, TheFirstWrongLaneIsNotExcused) {
  const Pair touching = pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0, 1, 1, 1, 3, 3, 1});
  static const AlgorithmInfo info{"excused", "test", "", "", "", false};
  Lane excused{"excused/f32/cpu", &info, Scalar::f32, Variant::cpu, "", {}, -1, nullptr, false, false, true,
               kOutsideTouching,  ""};
  Lane crashes = excused;
  crashes.id = "excused/f64/cpu";
  const Failure failure{
      relation_of(touching), Nesting::none, {&excused, &crashes}, {}, {Verdict::disjoint, Verdict::crashed}};
  EXPECT_EQ(failure.first_wrong(touching).id, "excused/f64/cpu");
  const Failure both{
      relation_of(touching), Nesting::none, {&crashes, &excused}, {}, {Verdict::crashed, Verdict::disjoint}};
  EXPECT_EQ(both.first_wrong(touching).id, "excused/f64/cpu");
  Lane strict = excused;
  strict.outside = 0;
  const Failure wrong{
      relation_of(touching), Nesting::none, {&strict, &crashes}, {}, {Verdict::disjoint, Verdict::crashed}};
  EXPECT_EQ(&wrong.first_wrong(touching), &strict);
}

TEST(Minimise, ConfirmRefusesAnotherFailure) {
  const std::vector<Case> cases = cases_of(strata::Stratum::near_edge_edge, 1);
  ASSERT_GE(cases.size(), 2u);
  const Pair apart = pair_of({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 1, 0, 5, 0, 1, 5});
  for (const Case& c : cases) {
    EXPECT_NO_THROW(confirm(under_test(), c.failure, c.pair));
    EXPECT_ANY_THROW(confirm(under_test(), c.failure, apart));
    Failure other = c.failure;
    other.verdicts.front() = other.verdicts.front() == Verdict::disjoint ? Verdict::intersects : Verdict::disjoint;
    EXPECT_ANY_THROW(confirm(under_test(), other, c.pair));
  }
}

TEST(Minimise, NothingFailsOnPairsThatAreRightOrNotFinite) {
  Pair pair = pair_of({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 1, 0, 5, 0, 1, 5});
  EXPECT_TRUE(failures_of(under_test(), pair).empty());
  pair.a[0].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(failures_of(under_test(), pair).empty());
}

TEST(MinimisedCases, StandBeforeTheOriginalsAndAreRecognised) {
  std::ostringstream out;
  corpus::write_header(out);
  out << "# a comment\n";
  const std::vector<Case> cases = cases_of(strata::Stratum::near_edge_edge, 2);
  for (const Case& c : cases) {
    corpus::write_entry(out, {c.pair, {{"signature", analysis::key(signature_of(c.failure, c.pair))}}, 0});
  }
  const auto read = [](const std::string& from) {
    std::istringstream in(from);
    corpus::PairReader reader(in, "test");
    std::vector<corpus::Entry> entries;
    while (std::optional<corpus::Entry> entry = reader.next()) entries.push_back(std::move(*entry));
    return entries;
  };
  const std::string fresh = out.str();
  const std::vector<corpus::Entry> entries = read(fresh);
  EXPECT_FALSE(has_result(under_test(), entries));
  const std::vector<MinimisedCase> results = minimise_cases(under_test(), entries);
  ASSERT_FALSE(results.empty());
  const std::string once = with_results(fresh, entries, results);
  const std::vector<corpus::Entry> all = read(once);
  ASSERT_EQ(all.size(), entries.size() + 2 * results.size());
  EXPECT_EQ(*field(all[0], "kind"), "minimised");
  EXPECT_EQ(*field(all[1], "kind"), "worst");
  for (std::size_t i = 0; i < entries.size(); ++i)
    EXPECT_TRUE(same_bits(all[2 * results.size() + i].pair, entries[i].pair));
  EXPECT_TRUE(has_result(under_test(), all));
  EXPECT_EQ(with_results(once, all, minimise_cases(under_test(), all)), once);
  EXPECT_TRUE(is_minimised_from(once, fresh));
  EXPECT_TRUE(is_minimised_from(fresh, fresh));
  EXPECT_FALSE(is_minimised_from("", fresh));
  EXPECT_FALSE(is_minimised_from(once + "x", fresh));
  EXPECT_FALSE(is_minimised_from(once, once + fresh.substr(fresh.find('#'))));
  EXPECT_FALSE(has_result(select_lanes({"*/f32/cpu"}), all));
}

}  // namespace
}  // namespace graze::fuzz
