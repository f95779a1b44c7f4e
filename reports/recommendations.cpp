// SPDX-License-Identifier: Apache-2.0
#include "reports/recommendations.h"

#include <algorithm>
#include <optional>

#include "reports/cost_words.h"

namespace graze::reports {
namespace {

Share wrong_share(const CampaignCounts& counts, std::size_t lane) {
  return share_of(counts.total.wrong(lane), counts.total.pairs);
}

template <class Holds>
LaneIndices those(const LaneIndices& among, const Holds& holds) {
  LaneIndices places;
  std::copy_if(among.begin(), among.end(), std::back_inserter(places), holds);
  return places;
}

// Pairs on which the lane's verdict is wrong or declined.
std::uint64_t not_right(const CampaignCounts& counts, std::size_t lane) { return counts.total.lanes[lane].not_right(); }

Share share_not_right(const CampaignCounts& counts, std::size_t lane) {
  return share_of(not_right(counts, lane), counts.total.pairs);
}

// The strata on which costs are compared: the general pairs if there are any, because exact decisions are known to be
// slow on other pairs. If both coordinate types have general pairs, only those of float32 count.
struct Ground {
  std::vector<std::size_t> strata;
  std::string pair;  // "a general pair"
};

Ground ground_of(const CampaignCounts& counts) {
  const GroupCounts* general = counts.group("general");
  if (!general) return {counts.drawn(), "a pair"};
  return {general->strata, counts.group("general/f64") ? "a general pair of float32" : "a general pair"};
}

std::optional<Cost> cost_of(const Costs* costs, std::size_t lane, const std::vector<std::size_t>& strata) {
  return costs ? costs->of(lane, strata) : std::nullopt;
}

// The cheapest lane on these strata. Nothing if none was timed.
std::optional<std::size_t> cheapest(const Costs* costs, const LaneIndices& among,
                                    const std::vector<std::size_t>& strata) {
  std::optional<std::size_t> best;
  for (const std::size_t l : among) {
    const std::optional<Cost> cost = cost_of(costs, l, strata);
    if (cost && (!best || cost->middle < costs->of(*best, strata)->middle)) best = l;
  }
  return best;
}

LaneIndices exact_lanes(const CampaignCounts& counts) {
  LaneIndices places;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    if (counts.lanes[l].exact) places.push_back(l);
  }
  return places;
}

// "; over all strata 210 ns against 61". Empty if the comparison already covers all strata.
std::string over_all_strata(const CampaignCounts& counts, const Costs* costs, const Ground& ground, std::size_t exact,
                            std::size_t other) {
  const std::vector<std::size_t> all = counts.drawn();
  const std::optional<Cost> own = cost_of(costs, exact, all), others = cost_of(costs, other, all);
  if (ground.strata == all || !own || !others) return "";
  return fmt::format("; over all strata {} against {}", cost_words(*own), cost_words(*others));
}

// The end of a sentence: what the exact lane costs.
std::string price(const CampaignCounts& counts, const Costs* costs, const LaneIndices& exact) {
  if (!costs) return ". Its cost depends on the machine; costs.json has it if the campaign was timed.";
  const Ground ground = ground_of(counts);
  const std::optional<std::size_t> lane = cheapest(costs, exact, ground.strata);
  if (!lane) return ". Its cost is not settled: the campaign has no timings of it.";
  const Cost cost = *costs->of(*lane, ground.strata);
  const std::optional<std::size_t> other = cheapest(costs, published(counts), ground.strata);
  const std::string which = exact.size() > 1 ? counts.lanes[*lane].id + " at" : "at";
  if (!other) return fmt::format(", {} {} {}.", which, cost_words(cost), ground.pair);
  const Cost others = *costs->of(*other, ground.strata);
  const std::string& id = counts.lanes[*other].id;
  const std::string everywhere = over_all_strata(counts, costs, ground, *lane, *other);
  if (is_cheaper(cost, others)) {
    return fmt::format(", {} {} {} against {} for the fastest published lane, {}{}.", which, cost_words(cost),
                       ground.pair, cost_words(others), id, everywhere);
  }
  if (!is_cheaper(others, cost)) {
    return fmt::format(
        ", {} {} {}. Whether the fastest published lane, {} at {}, is cheaper is not settled: their spreads "
        "overlap{}.",
        which, cost_words(cost), ground.pair, id, cost_words(others), everywhere);
  }
  return fmt::format(", {} {} {}. The fastest published lane, {}, takes {}{}; it is wrong on {} of all pairs.", which,
                     cost_words(cost), ground.pair, id, cost_words(others), everywhere,
                     rate_words(wrong_share(counts, *other).share));
}

// The best lane, according to `better`, outside the family of the lane `than`. Nothing if there is none.
template <class Better>
std::optional<std::size_t> first_of_others(const CampaignCounts& counts, const LaneIndices& lanes, std::size_t than,
                                           Better better) {
  const LaneIndices others = those(lanes, [&](std::size_t l) { return !same_family(counts, l, than); });
  if (others.empty()) return {};
  return *std::min_element(others.begin(), others.end(), better);
}

std::string not_settled(const CampaignCounts& counts, const char* which, std::size_t l, std::size_t r,
                        Share (*share_of_lane)(const CampaignCounts&, std::size_t), const char* what) {
  const auto interval = [&](std::size_t lane) {
    const Share share = share_of_lane(counts, lane);
    return fmt::format("{} to {}", rate_words(share.low, Bound::lower), rate_words(share.high, Bound::upper));
  };
  return fmt::format(
      "Which published lane is {} is not settled: the 95 % intervals of {}, {} on {} of all pairs, and {}, on {}, "
      "overlap.",
      which, counts.lanes[l].id, what, interval(l), counts.lanes[r].id, interval(r));
}

// ", at 82 ns a general pair": the cost of the cheapest lane.
std::string at_cost(const CampaignCounts& counts, const Costs* costs, const LaneIndices& lanes) {
  const Ground ground = ground_of(counts);
  const std::optional<std::size_t> lane = cheapest(costs, lanes, ground.strata);
  if (!lane) return "";
  return fmt::format(", {}at {} {}", lanes.size() == 1 ? "" : counts.lanes[*lane].id + " ",
                     cost_words(*costs->of(*lane, ground.strata)), ground.pair);
}

// "; bound declines 1,200 pairs", for each lane that declines pairs.
std::string declining(const CampaignCounts& counts, const LaneIndices& lanes) {
  std::string text;
  for (const std::size_t l : lanes) {
    if (const std::uint64_t declined = counts.total.lanes[l].declined; declined > 0)
      text += fmt::format("; {} declines {} pairs", counts.lanes[l].id, grouped(declined));
  }
  return text;
}

}  // namespace

Sentence lane_to_use(const CampaignCounts& counts, const Costs* costs) {
  const LaneIndices exact = exact_lanes(counts);
  if (exact.empty()) return {"No exact lane ran, so there is none to recommend for every pair.", false};
  for (const std::size_t l : exact) {
    const std::uint64_t not_right = counts.total.lanes[l].not_right();
    if (not_right == 0) continue;
    return {
        fmt::format("{} is wrong or declines on {} of {} pairs, which must never happen: trust no exact lane before "
                    "this is explained.",
                    counts.lanes[l].id, grouped(not_right), grouped(counts.total.pairs))};
  }
  return {fmt::format("Use {}: right on all {} pairs{}", ids(counts, exact), grouped(counts.total.pairs),
                      price(counts, costs, exact))};
}

Sentence lane_to_avoid(const CampaignCounts& counts, const Costs* costs) {
  const LaneIndices lanes = published(counts);
  const auto wrong = [&](std::size_t l) { return counts.total.wrong(l); };
  const std::size_t worst =
      *std::max_element(lanes.begin(), lanes.end(), [&](auto l, auto r) { return wrong(l) < wrong(r); });
  if (wrong(worst) == 0) return {"No lane need be avoided: none is wrong on any pair of this campaign."};
  const auto next = first_of_others(counts, lanes, worst, [&](auto l, auto r) { return wrong(l) > wrong(r); });
  if (!next) {
    const LaneName& name = counts.lanes[worst].name;
    return {fmt::format("Only published lanes of {}/{} ran, so the campaign does not say which to avoid.", name.subject,
                        name.scalar),
            false};
  }
  if (!wrong_share(counts, worst).apart(wrong_share(counts, *next)))
    return {not_settled(counts, "worst", worst, *next, wrong_share, "wrong")};
  const analysis::LaneCounts& found = counts.total.lanes[worst];
  const LaneIndices equals = those(lanes, [&](std::size_t l) {
    const analysis::LaneCounts& of = counts.total.lanes[l];
    return of.wrong() == found.wrong() && of.false_positive == found.false_positive &&
           of.false_negative == found.false_negative;
  });
  std::string text = fmt::format("Avoid {}: wrong on {}, {} false positives and {} false negatives",
                                 ids(counts, equals), with_interval(wrong_share(counts, worst), " pairs"),
                                 grouped(found.false_positive), grouped(found.false_negative));
  std::uint64_t general = 0, wrong_general = 0;
  for (const char* id : {"general", "general/f64"}) {
    const GroupCounts* group = counts.group(id);
    if (!group) continue;
    general += group->counts.pairs;
    wrong_general += group->counts.wrong(worst);
  }
  if (general > 0 && general != counts.total.pairs)
    text += fmt::format("; on {} of the general pairs", rate_words(wrong_general, general));
  const Ground ground = ground_of(counts);
  const std::optional<Cost> own = cost_of(costs, worst, ground.strata);
  const std::size_t least = *std::min_element(
      lanes.begin(), lanes.end(), [&](auto l, auto r) { return not_right(counts, l) < not_right(counts, r); });
  const std::optional<Cost> better = cost_of(costs, least, ground.strata);
  if (own && better && is_cheaper(*better, *own)) {
    text += fmt::format(". {} is both less often wrong and cheaper, {} {} against {}", counts.lanes[least].id,
                        cost_words(*better), ground.pair, cost_words(*own));
  }
  return {text + "."};
}

// If some lanes decline pairs, the sentence names the lane that is right most often, which is never one that declines
// everything.
Sentence least_wrong_lane(const CampaignCounts& counts, const Costs* costs) {
  const LaneIndices lanes = published(counts);
  const StratumCounts& total = counts.total;
  const auto less = [&](std::size_t l, std::size_t r) { return not_right(counts, l) < not_right(counts, r); };
  const std::size_t least = *std::min_element(lanes.begin(), lanes.end(), less);
  // The smallest number of pairs that any of these lanes decides.
  const auto decided = [&](const LaneIndices& of) {
    std::uint64_t pairs = total.pairs;
    for (const std::size_t l : of) pairs = std::min(pairs, total.pairs - total.lanes[l].declined);
    return pairs;
  };
  const bool any_declines = decided(lanes) < total.pairs;
  const auto bound = [](std::uint64_t pairs) { return rate_words(bound_of_none(pairs), Bound::upper); };
  if (std::all_of(lanes.begin(), lanes.end(), [&](std::size_t l) { return total.wrong(l) == 0; })) {
    const std::uint64_t pairs = decided(lanes);
    return {fmt::format("{} wrong on none of {} pairs{}{}.",
                        lanes.size() == 1 ? fmt::format("The only published lane, {}, is", counts.lanes[least].id)
                                          : fmt::format("All {} published lanes are", lanes.size()),
                        grouped(total.pairs),
                        pairs == 0 ? ""
                                   : fmt::format(", so with 95 % confidence {} on fewer than {} of such pairs",
                                                 lanes.size() == 1 ? "it errs" : "each errs", bound(pairs)),
                        declining(counts, lanes))};
  }
  const char* which = any_declines ? "most often right" : "least wrong";
  const std::optional<std::size_t> next = first_of_others(counts, lanes, least, less);
  if (next && !share_not_right(counts, least).apart(share_not_right(counts, *next)))
    return {not_settled(counts, which, least, *next, share_not_right,
                        any_declines ? "wrong or without a verdict" : "wrong")};
  const LaneIndices best = those(lanes, [&](std::size_t l) {
    return not_right(counts, l) == not_right(counts, least) && total.wrong(l) == total.wrong(least);
  });
  const std::string found =
      total.wrong(least) > 0
          ? fmt::format("{} of {} pairs", with_interval(wrong_share(counts, least)), grouped(total.pairs))
      : decided(best) == 0 ? fmt::format("none of {} pairs", grouped(total.pairs))
                           : fmt::format("none of {} pairs (with 95 % confidence fewer than {})", grouped(total.pairs),
                                         bound(decided(best)));
  const std::string cost = at_cost(counts, costs, best);
  if (lanes.size() == 1)
    return {fmt::format("The only published lane, {}, is wrong on {}{}{}.", counts.lanes[least].id, found, cost,
                        declining(counts, lanes))};
  return {fmt::format("Of the {} published lanes the {} {} {}: {}on {}{}{}.", lanes.size(), which,
                      best.size() == 1 ? "is" : "are", ids(counts, best), any_declines ? "wrong " : "", found, cost,
                      declining(counts, best))};
}

}  // namespace graze::reports
