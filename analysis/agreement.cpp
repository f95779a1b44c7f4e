// SPDX-License-Identifier: Apache-2.0
#include "analysis/agreement.h"

#include <algorithm>
#include <tuple>

namespace graze::analysis {
namespace {

// Whether the lanes agree on AgreeSpec::sources. clearly: the rate on fresh pairs will almost surely be at most
// max_rate too.
enum class Agrees { clearly, perhaps, no };

Agrees agrees(const Agreement& agreement, double max_rate) {
  if (static_cast<double>(agreement.differing) > max_rate * static_cast<double>(agreement.pairs)) return Agrees::no;
  const bool clear = agreement.differing == 0 || upper_bound(agreement.differing, agreement.pairs) <= max_rate / 2;
  return clear ? Agrees::clearly : Agrees::perhaps;
}

std::uint64_t not_right(const Agreement& agreement) {
  return agreement.of[0].not_right() + agreement.of[1].not_right();
}

// The index of the smallest tolerance under which the lanes clearly agree. If there is none, the smallest tolerance
// under which they may agree; if there is none either, the tolerance with the fewest differing verdicts.
std::size_t best_of(const CurveOf<Agreement>& curve, const Agreement& zero, double max_rate) {
  const auto rank = [&](const Agreement& point) {
    const Agrees agree = agrees(point, max_rate);
    return std::tuple(is_blunt(point, zero), agree, agree == Agrees::no ? point.differing : 0);
  };
  const auto best = std::min_element(curve.points.begin(), curve.points.end(),
                                     [&](const Agreement& l, const Agreement& r) { return rank(l) < rank(r); });
  return static_cast<std::size_t>(best - curve.points.begin());
}

}  // namespace

bool is_blunt(const Agreement& under, const Agreement& zero) {
  const std::uint64_t by_one_answer = std::min(under.intersecting, under.pairs - under.intersecting);
  for (int l = 0; l < 2; ++l) {
    const std::uint64_t wrong = under.of[l].not_right();
    if (wrong > zero.of[l].not_right() && wrong >= by_one_answer) return true;
  }
  return false;
}

TuneResult agreement_result(const Agreement& chosen_on, const Agreement& confirmed, double max_rate) {
  if (upper_bound(confirmed.differing, confirmed.pairs) <= max_rate) return TuneResult::satisfied;
  if (lower_bound(confirmed.differing, confirmed.pairs) <= max_rate) return TuneResult::too_few_pairs;
  return agrees(chosen_on, max_rate) == Agrees::no ? TuneResult::not_satisfiable : TuneResult::not_confirmed;
}

Agreed agree(const AgreeSpec& spec) {
  Agreed result;
  const std::vector<std::string> none = {""};
  result.zero = spec.sweep(none, spec.sources).front();
  std::vector<std::string> sites = {""};
  sites.insert(sites.end(), spec.sites.begin(), spec.sites.end());
  for (const std::string& site : sites) {
    if (spec.relative) result.curves.push_back({site, true, {}});
    result.curves.push_back({site, false, {}});
  }
  const auto best = [&](const CurveOf<Agreement>& curve) { return best_of(curve, result.zero, spec.max_rate); };
  sweep_curves(
      result.curves, log2_cube(spec.sources), [&](Policies policies) { return spec.sweep(policies, spec.sources); },
      best);

  const auto rank = [&](const Agreement& point) {
    const Agrees agree = agrees(point, spec.max_rate);
    return std::tuple(agree, agree == Agrees::no ? point.differing : not_right(point));
  };
  const Agreement* chosen = &result.zero;
  const bool needs_policy = agrees(result.zero, spec.max_rate) == Agrees::no;
  std::vector<std::string> policies = {""};
  for (const CurveOf<Agreement>& curve : result.curves) {
    const Agreement& pick = curve.points[best(curve)];
    policies.push_back(pick.policy);
    if (needs_policy && !is_blunt(pick, result.zero) && rank(pick) < rank(*chosen)) chosen = &pick;
    for (const Agreement& point : curve.points) {
      if (is_blunt(point, result.zero) && agrees(point, spec.max_rate) != Agrees::no &&
          (!result.blunt || rank(point) < rank(*result.blunt)))
        result.blunt = point;
    }
  }
  result.chosen = chosen->policy;
  policies.push_back(result.chosen);
  result.picks = spec.sweep(policies, spec.others);
  result.zero_confirmed = result.picks.front();
  result.confirmed = result.picks.back();
  result.picks.pop_back();
  result.picks.erase(result.picks.begin());
  result.low = lower_bound(result.confirmed.differing, result.confirmed.pairs);
  result.high = upper_bound(result.confirmed.differing, result.confirmed.pairs);
  if (agrees(*chosen, spec.max_rate) != Agrees::no) result.blunt.reset();
  result.result = agreement_result(*chosen, result.confirmed, spec.max_rate);
  if (spec.rounded) result.rounded = spec.rounded(none, spec.others).front();
  return result;
}

}  // namespace graze::analysis
