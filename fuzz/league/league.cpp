// SPDX-License-Identifier: Apache-2.0
#include "fuzz/league/league.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <span>

#include "analysis/convention.h"
#include "analysis/invariants.h"
#include "analysis/neighbours.h"
#include "analysis/pareto.h"
#include "analysis/tally.h"
#include "core/lanes/convention.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"
#include "fuzz/league/smallest.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimise.h"
#include "strata/groups.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kBatchPairs = 1 << 16;  // large: each lane that fails in a batch needs a fresh process
constexpr std::size_t kBlockPairs = 1024;
constexpr std::uint64_t kOrderSample = 950;  // pairs decided in all orders, split evenly among the strata
constexpr std::uint64_t kOrderShare = 20;    // but at most one in 20 of a lane's pairs

template <class Real>
Relation true_of(const BasicPair<Real>& pair) {
  const Relation found = relation_of(pair);
  if (found.verdict != oracle::cgal_verdict(pair))
    throw oracle::OracleMismatch(pair_text(pair) + ": CGAL and the exact decision differ");
  return found;
}

// A row of the league's table, with the data needed to count it.
struct Counting {
  LeagueRow row;
  const Lane* fused;  // its cpu-fma counterpart; null for none
  const DecideBlock* decide;
  std::uint64_t of_source;  // the lane gets at most this many pairs of each source, from the first on
  Smallest smallest;

  // Confirms with GMP the truth of a pair on which the lane is wrong.
  template <class Real>
  void confirm(const BasicPair<Real>& pair, const Relation& truth) const {
    const Contact contact = oracle::gmp_contact(pair);
    if (contact != truth.contact) {
      throw oracle::OracleMismatch(fmt::format("{}: the exact decision says contact {}, GMP {}", pair_text(pair),
                                               name(truth.contact), name(contact)));
    }
  }

  template <class Real>
  void count(std::span<const BasicPair<Real>> pairs, const std::vector<Relation>& truths, LeagueCounts& counts) {
    const std::vector<Verdict> said = verdicts_of(*decide, pairs);
    std::vector<std::size_t> not_right;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      ++(is_outside(row.lane->outside, pairs[i], truths[i]) ? counts.outside : counts.pairs);
      if (said[i] == truths[i].verdict) continue;
      if (analysis::by_convention(*row.lane, said[i], pairs[i], truths[i])) {
        ++counts.by_convention;
      } else {
        not_right.push_back(i);
      }
    }
    count_not_right(pairs, truths, said, not_right, counts);
    if (!fused) return;
    const std::vector<Verdict> other = verdicts_of(fused->decide, pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i) *row.flips += said[i] != other[i];
  }

  template <class Real>
  void count_not_right(std::span<const BasicPair<Real>> pairs, const std::vector<Relation>& truths,
                       const std::vector<Verdict>& said, const std::vector<std::size_t>& not_right,
                       LeagueCounts& counts) {
    std::vector<BasicPair<Real>> again_of;
    for (const std::size_t i : not_right) again_of.push_back(pairs[i]);
    const std::vector<Verdict> again = verdicts_in_fresh_process<Real>(*row.lane, again_of);
    for (std::size_t k = 0; k < not_right.size(); ++k) {
      const std::size_t i = not_right[k];
      confirm(pairs[i], truths[i]);
      if (again[k] != said[i]) {
        ++counts.not_repeated;
        continue;
      }
      ++counts.of(said[i]);
      if (!is_wrong(said[i], truths[i].verdict)) continue;
      const std::string_view shape = shape_name(truths[i].hulls);
      if (shape == "general" && truths[i].margin_sign != 0) {
        const int exponent = std::abs(int{oracle::margin_bucket(pairs[i], truths[i].verdict)}) + kBucketLowest - 1;
        counts.clear += exponent >= kClearExponent;
        if (exponent >= kClearExponent) smallest.add(kClear, said[i], pairs[i]);
      }
      smallest.add(shape, said[i], pairs[i]);
    }
  }

  // Whether the verdict breaks an invariant on an image within the lane's contract. Orders are counted separately.
  template <class Real>
  bool breaks_an_invariant(const BasicPair<Real>& pair, Verdict of_pair) const {
    std::vector<BasicPair<Real>> all;
    std::vector<analysis::Invariant> invariants;
    for (const analysis::InvariantInfo& invariant : analysis::kInvariants) {
      if (invariant.invariant == analysis::Invariant::swap || invariant.invariant == analysis::Invariant::order)
        continue;
      const std::vector<BasicPair<Real>> images = analysis::images(invariant.invariant, pair);
      all.insert(all.end(), images.begin(), images.end());
      invariants.resize(all.size(), invariant.invariant);
    }
    const std::vector<Verdict> said = verdicts_of(*decide, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool open =
          invariants[i] == analysis::Invariant::part && is_outside(row.lane->outside, all[i], relation_of(all[i]));
      if (!open && analysis::breaks(invariants[i], of_pair, said[i])) return true;
    }
    return false;
  }

  // Counts pairs whose verdict changes with the vertex order, and pairs whose verdict breaks another invariant. Pairs
  // outside the lane's contract are skipped.
  template <class Real>
  void count_orders(std::span<const BasicPair<Real>> pairs, const std::vector<Relation>& truths) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (is_outside(row.lane->outside, pairs[i], truths[i])) continue;
      ++row.order_sample;
      const std::vector<Verdict> said = verdicts_of(*decide, analysis::orders(pairs[i]));
      row.order_dependent += std::adjacent_find(said.begin(), said.end(), std::not_equal_to<>()) != said.end();
      row.breaks_invariant += breaks_an_invariant(pairs[i], said.front());
    }
  }
};

template <class Real>
std::vector<Relation> truths_of(const std::vector<BasicPair<Real>>& pairs) {
  std::vector<Relation> truths(pairs.size());
  tbb::parallel_for(std::size_t{0}, (pairs.size() + kBlockPairs - 1) / kBlockPairs, [&](std::size_t block) {
    for (std::size_t i = block * kBlockPairs; i < std::min(pairs.size(), (block + 1) * kBlockPairs); ++i)
      truths[i] = true_of(pairs[i]);
  });
  return truths;
}

}  // namespace

LeagueGroup league_group(std::string_view stratum) {
  if (stratum.starts_with("near_") || strata::stratum_in_doubles(stratum).value_or(stratum) == "exact_contact")
    return LeagueGroup::near;
  switch (strata::group_of_name(stratum).value_or(strata::Group::general)) {
    case strata::Group::coplanar:
      return LeagueGroup::coplanar;
    case strata::Group::degenerate:
      return LeagueGroup::degenerate;
    case strata::Group::extreme:
      return LeagueGroup::extreme;
    default:
      return LeagueGroup::general;
  }
}

LeagueCounts& LeagueCounts::operator+=(const LeagueCounts& other) {
  Counts::operator+=(other);
  pairs += other.pairs;
  clear += other.clear;
  outside += other.outside;
  not_repeated += other.not_repeated;
  return *this;
}

SelectedLanes league_lanes(const std::vector<std::string>& globs) {
  SelectedLanes lanes = select_lanes(globs, Executor::twin);
  lanes.keep_if([](const Lane& lane) { return lane.variant == Variant::cpu || lane.variant == Variant::cpu_fma; });
  return lanes;
}

League run_league(const SelectedLanes& under_test, std::vector<strata::PairSource> sources, std::uint64_t seed,
                  const MostPairs& most, const std::function<bool(std::uint64_t)>& stop) {
  std::vector<Counting> all;
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
    const Lane& lane = *under_test.lanes[l];
    if (lane.variant != Variant::cpu) continue;
    const Lane* fused = counterpart(lane, Variant::cpu_fma);
    if (fused && !runs_on_this_cpu(*fused)) fused = nullptr;
    const auto limit = most.find(lane.info->id);
    const std::uint64_t of_source =
        limit == most.end() ? ~std::uint64_t{0} : std::max<std::uint64_t>(1, limit->second / sources.size());
    all.push_back({{&lane, {}, 0, 0, 0, fused ? std::optional<std::uint64_t>(0) : std::nullopt},
                   fused,
                   &under_test.on_host[l],
                   of_source,
                   {}});
  }
  League league;
  league.seed = seed;
  bool stopped = false;
  // Counts these pairs of a source of `of_source` pairs. begin: the first pair's index in the source.
  const auto count = [&](const auto& pairs, std::uint64_t begin, std::uint64_t of_source, std::size_t group) {
    const std::vector<Relation> truths = truths_of(pairs);
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t l) {
      const std::uint64_t its = std::min(of_source, all[l].of_source);
      if (its <= begin) return;
      const auto first = [&](std::uint64_t many) {
        return std::span(pairs).first(std::min<std::uint64_t>(pairs.size(), many));
      };
      all[l].count(first(its - begin), truths, all[l].row.groups[group]);
      if (begin > 0) return;
      all[l].count_orders(first(std::clamp<std::uint64_t>(its / kOrderShare, 1,
                                                          std::max<std::uint64_t>(1, kOrderSample / sources.size()))),
                          truths);
    });
  };
  for (const strata::PairSource& source : sources) {
    league.strata.push_back(source.id);
    const auto group = static_cast<std::size_t>(league_group(source.id));
    for (std::uint64_t begin = 0; begin < source.pairs && !stopped; begin += kBatchPairs) {
      const strata::PairBlock pairs =
          strata::pairs_of(source, begin, std::min<std::uint64_t>(kBatchPairs, source.pairs - begin));
      pairs.in_doubles() ? count(pairs.doubles, begin, source.pairs, group)
                         : count(pairs.floats, begin, source.pairs, group);
      league.pairs += pairs.size();
      stopped = stop(league.pairs);
    }
  }
  std::vector<Candidate> candidates;
  for (const Counting& counting : all) {
    league.rows.push_back(counting.row);
    counting.smallest.add_candidates(*counting.row.lane, candidates);
  }
  league.in_doubles = sources.front().in_doubles();
  if (!stopped) league.failures = smallest_failures(candidates, league.failures_not_repeated);
  return league;
}

std::vector<std::optional<double>> league_costs(const League& league) {
  const PairTypes types = league.in_doubles ? PairTypes::f64 : PairTypes::f32;
  const strata::PairBlock pairs = strata::pairs_of(
      strata::stratum_sources(league.seed, kLeagueTimedPairs, {"uniform"}, types).front(), 0, kLeagueTimedPairs);
  std::vector<const Lane*> lanes;
  for (const LeagueRow& row : league.rows) lanes.push_back(row.lane);
  std::vector<std::optional<double>> medians;
  for (const std::optional<analysis::Cost>& cost : analysis::costs_of(lanes, pairs, kLeagueRepetitions))
    medians.push_back(cost ? std::optional(cost->middle) : std::nullopt);
  return medians;
}

}  // namespace graze::fuzz
