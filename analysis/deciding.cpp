// SPDX-License-Identifier: Apache-2.0
#include "analysis/deciding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graze::analysis {
namespace {

// The exact number in the lane's scalar: with the exact sign, and finite.
double in_scalar(const oracle::Beside& beside, Scalar scalar) {
  const bool f32 = scalar == Scalar::f32;
  const double most = f32 ? double{std::numeric_limits<float>::max()} : std::numeric_limits<double>::max();
  const double least =
      f32 ? double{std::numeric_limits<float>::denorm_min()} : std::numeric_limits<double>::denorm_min();
  if (beside.decimal == "0" || std::isnan(beside.exact)) return beside.exact;
  const double clamped = std::clamp(beside.exact, -most, most);
  const double rounded = f32 ? double{static_cast<float>(clamped)} : clamped;
  return rounded != 0 ? rounded : beside.decimal.front() == '-' ? -least : least;
}

class Search {
 public:
  Search(const Lane& lane, const Pair& pair, Verdict truth, const Replay& replay,
         const std::vector<oracle::ExactStep>& exact, int bits, const WithoutCause& without_cause)
      : lane_(lane),
        pair_(pair),
        truth_(truth),
        replay_(replay),
        exact_(exact),
        bits_(bits),
        without_cause_(without_cause) {}

  // Sets of one more comparison than `chosen`, then those of two more, as far as the budget goes.
  Deciding find() {
    std::vector<std::vector<Decider>> sets{{}};
    for (int size = 1; size <= kMostInSet && !sets.empty(); ++size) {
      std::vector<std::vector<Decider>> larger;
      for (const std::vector<Decider>& chosen : sets) {
        if (budget_-- == 0) return all_in_turn();
        for (Decider& next : wrong_after(chosen)) {
          std::vector<Decider> set = chosen;
          set.push_back(std::move(next));
          if (run_with(set).verdict == truth_) return {std::move(set)};
          larger.push_back(std::move(set));
        }
      }
      sets = std::move(larger);
    }
    return all_in_turn();
  }

 private:
  static constexpr int kMostInSet = 3;
  static constexpr std::size_t kMostInTurn = 64;

  Trace<double> run_with(const std::vector<Decider>& set) const {
    std::vector<Correction<double>> corrections;
    for (const Decider& decider : set) corrections.push_back(decider.to_exact);
    return run_led(lane_, pair_, replay_.rule, {}, corrections);
  }

  // In the run with those corrected: what else goes wrong, and right without the cause.
  std::vector<Decider> wrong_after(const std::vector<Decider>& chosen) const {
    if (chosen.empty()) return wrong_in(replay_.run, exact_, chosen);
    const Trace<double> run = run_with(chosen);
    return wrong_in(run, oracle::exact_steps(lane_.algorithm, lane_.scalar, pair_, run, bits_), chosen);
  }

  std::vector<Decider> wrong_in(const Trace<double>& run, const std::vector<oracle::ExactStep>& exact,
                                const std::vector<Decider>& chosen) const {
    const Path path = path_of(run);
    std::vector<Decider> result;
    Trace<double> without;
    std::size_t comparison = 0;
    for (std::size_t i = 0; i < run.seen.size(); comparison += run.seen[i].compared, ++i) {
      const Seen<double>& seen = run.seen[i];
      if (!seen.compared || seen.taken == exact[i].held || corrects(chosen, seen)) continue;
      if (without_cause_ && without.seen.empty()) without = without_cause_(path);
      // What is not finite any more is the cause's doing, whatever rounding would say in its place.
      const bool finite = std::isfinite(seen.left) && std::isfinite(seen.right);
      if (without_cause_ && finite && without.seen[i].held != exact[i].held) continue;
      result.push_back({i,
                        seen,
                        exact[i],
                        Path(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(comparison)),
                        {seen.left_result, seen.right_result, in_scalar(exact[i].left, lane_.scalar),
                         in_scalar(exact[i].right, lane_.scalar), seen.relation, exact[i].held},
                        {seen.left_result, seen.right_result, seen.left, seen.right, seen.relation, seen.taken}});
    }
    return result;
  }

  static bool is_same(const Seen<double>& l, const Seen<double>& r) {
    return l.left_result == r.left_result && l.right_result == r.right_result && l.relation == r.relation;
  }
  static bool corrects(const std::vector<Decider>& chosen, const Seen<double>& seen) {
    return std::any_of(chosen.begin(), chosen.end(), [&](const Decider& d) { return is_same(d.seen, seen); });
  }

  // The set without one of them, if each of the others still goes wrong once those before it are corrected; else none.
  std::vector<Decider> without_one(const std::vector<Decider>& set, std::size_t spared) const {
    std::vector<Decider> result;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (i == spared) continue;
      std::vector<Decider> wrong = wrong_after(result);
      const auto again =
          std::find_if(wrong.begin(), wrong.end(), [&](const Decider& d) { return is_same(d.seen, set[i].seen); });
      if (again == wrong.end()) return {};
      result.push_back(std::move(*again));
    }
    return result;
  }

  // Corrects what goes wrong first until the verdict is right, and leaves out what is not needed.
  Deciding all_in_turn() const {
    std::vector<Decider> set;
    while (set.empty() || run_with(set).verdict != truth_) {
      std::vector<Decider> wrong = wrong_after(set);
      if (wrong.empty() || set.size() == kMostInTurn) return {};
      set.push_back(std::move(wrong.front()));
    }
    for (std::size_t i = set.size(); i-- > 0;) {
      std::vector<Decider> fewer = without_one(set, i);
      if (!fewer.empty() && run_with(fewer).verdict == truth_) set = std::move(fewer);
    }
    const bool smallest = set.size() == 1;
    return {std::move(set), smallest};
  }

  const Lane& lane_;
  const Pair& pair_;
  Verdict truth_;
  const Replay& replay_;
  const std::vector<oracle::ExactStep>& exact_;  // of the replay
  int bits_;
  WithoutCause without_cause_;
  int budget_ = 100;  // runs in exact arithmetic
};

}  // namespace

Deciding deciding_comparisons(const Lane& lane, const Pair& pair, Verdict truth, const Replay& replay,
                              const std::vector<oracle::ExactStep>& exact, int bits,
                              const WithoutCause& without_cause) {
  Deciding found = Search(lane, pair, truth, replay, exact, bits, without_cause).find();
  if (!found.comparisons.empty() || !without_cause) return found;
  found = Search(lane, pair, truth, replay, exact, bits, {}).find();
  found.by_cause = false;
  return found;
}

}  // namespace graze::analysis
