// SPDX-License-Identifier: Apache-2.0
#include "reports/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/text.h"
#include "reports/cost_words.h"
#include "reports/lane_words.h"
#include "reports/own_code.h"
#include "reports/tables.h"

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

std::uint64_t not_true(const CampaignCounts& counts, std::size_t lane) { return counts.total.lanes[lane].not_true(); }

Share share_not_true(const CampaignCounts& counts, std::size_t lane) {
  return share_of(not_true(counts, lane), counts.total.pairs);
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

// "; bound declines 1,200 pairs", for each lane with verdicts that are neither right nor wrong.
std::string not_counted(const CampaignCounts& counts, const LaneIndices& lanes) {
  std::string text;
  for (const std::size_t l : lanes) {
    const analysis::LaneCounts& of = counts.total.lanes[l];
    if (of.declined > 0) text += fmt::format("; {} declines {} pairs", counts.lanes[l].id, grouped(of.declined));
    if (of.by_convention > 0)
      text +=
          fmt::format("; the convention of {} allows {} other verdicts", counts.lanes[l].id, grouped(of.by_convention));
  }
  return text;
}

// A lane with contraction, and the same lane without it.
struct Contracted {
  std::size_t without, with;
  std::optional<std::uint64_t> differs;
};

std::vector<Contracted> contracted(const CampaignCounts& counts, const LaneIndices& lanes) {
  std::vector<Contracted> found;
  for (const std::size_t l : lanes) {
    const ReportLane& lane = counts.lanes[l];
    const std::optional<Variant> variant = variant_of_name(lane.name.variant);
    if (!variant || info_of(*variant).arithmetic != Arithmetic::contracted) continue;
    std::optional<std::size_t> without = counts.counterpart(l, name(rounded_variant(*variant)));
    if (!without) without = lane.cpu;
    if (without) found.push_back({*without, l, differs(counts, counts.total, *without, l)});
  }
  return found;
}

std::string contraction(const CampaignCounts& counts, const LaneIndices& lanes) {
  const std::vector<Contracted> all = contracted(counts, lanes);
  if (all.empty()) {
    const bool others = std::any_of(lanes.begin(), lanes.end(),
                                    [&](std::size_t l) { return !variant_of_name(counts.lanes[l].name.variant); });
    return others ? "Apart from toolchains, no lane with contraction ran beside the same lane without it; the map of "
                    "the toolchains shows where their verdicts differ."
                  : "No lane with contraction ran beside the same lane without it, so the campaign does not show what "
                    "contraction changes.";
  }
  const StratumCounts& total = counts.total;
  const auto moved = [&](const Contracted& c) {
    const std::uint64_t before = total.wrong(c.without), after = total.wrong(c.with);
    return before < after ? after - before : before - after;
  };
  const auto effect = [&](const Contracted& c) { return c.differs ? *c.differs : moved(c); };
  const bool counted = std::all_of(all.begin(), all.end(), [](const Contracted& c) { return c.differs.has_value(); });
  const auto most = std::max_element(all.begin(), all.end(), [&](const Contracted& l, const Contracted& r) {
    return std::pair(l.differs.has_value(), effect(l)) < std::pair(r.differs.has_value(), effect(r));
  });
  const auto changed = std::count_if(all.begin(), all.end(), [&](const Contracted& c) { return effect(c) != 0; });
  const std::string uncounted =
      counted ? "" : "; without a cpu lane beside them the campaign counts wrong verdicts, not changed ones";
  if (changed == 0) {
    return fmt::format("Contraction changes no {} of {} that ran with and without it{}.",
                       counted ? "verdict" : "number of wrong verdicts",
                       all.size() == 1 ? "the one lane" : fmt::format("{} lanes", all.size()), uncounted);
  }
  const std::string from_to = fmt::format("its wrong verdicts go from {} to {}", grouped(total.wrong(most->without)),
                                          grouped(total.wrong(most->with)));
  const std::string how_many = fmt::format("{} of {} lanes that ran with and without it change", changed, all.size());
  if (!most->differs) {
    return fmt::format("Contraction changes most in {}: compared with {}, {} of {} pairs; {}{}.",
                       counts.lanes[most->with].id, counts.lanes[most->without].id, from_to, grouped(total.pairs),
                       how_many, uncounted);
  }
  return fmt::format("Contraction changes most in {}: a different verdict from {} on {}, and {}; {}{}.",
                     counts.lanes[most->with].id, counts.lanes[most->without].id,
                     with_interval(share_of(*most->differs, total.pairs), " pairs"), from_to, how_many, uncounted);
}

// The rates were measured on 20,000,000 pairs for each reference triangle.
constexpr const char* kRateOf2012 =
    " The thesis saw about 1 in 1,000. Contraction in its own algorithm explains 1 in 3,270. The rest is unexplained. "
    "Built for the x87, and with the reference triangle of the thesis's special cases, that algorithm differs on 1 in "
    "1,300. The commands are in docs/measurements.md.";

std::string thesis(const CampaignCounts& counts, const LaneIndices& lanes) {
  const auto drawn = [&](const char* id) {
    const StratumCounts* of = counts.stratum(id);
    return of && of->pairs > 0 ? of : nullptr;
  };
  const StratumCounts *in_float32 = drawn("thesis"), *stratum = in_float32 ? in_float32 : drawn("thesis/f64");
  if (!stratum) {
    return "The triangles of the 2012 thesis (stratum thesis) were not drawn, so the campaign does not say how often "
           "CPU and GPU differ on them.";
  }
  const std::string pairs = grouped(stratum->pairs), in_doubles = in_float32 ? "" : ", in doubles,";
  const auto differing = [&](std::size_t l) { return stratum->lanes[l].differs_from_cpu; };
  LaneIndices compared;
  std::uint64_t without_contraction = 0;
  bool ran_without = false;
  for (const std::size_t l : lanes) {
    if (!counts.lanes[l].name.variant.starts_with("cuda") || !counts.lanes[l].cpu) continue;
    compared.push_back(l);
    if (counts.lanes[l].name.variant != name(Variant::cuda_nofma)) continue;
    ran_without = true;
    without_contraction += differing(l);
  }
  if (compared.empty()) {
    return fmt::format(
        "On the {} pairs of the 2012 thesis's triangles{} no CUDA lane ran beside its cpu lane, so the "
        "campaign does not say how often CPU and GPU differ.",
        pairs, in_doubles);
  }
  const std::size_t most = *std::max_element(compared.begin(), compared.end(),
                                             [&](std::size_t l, std::size_t r) { return differing(l) < differing(r); });
  if (differing(most) == 0) {
    return fmt::format(
        "On the 2012 thesis's triangles{} CPU and GPU agree: none of {} CUDA lanes differs from its cpu "
        "lane on any of {} pairs (with 95 % confidence fewer than {}).",
        in_doubles, compared.size(), pairs, rate_words(bound_of_none(stratum->pairs), Bound::upper));
  }
  const std::optional<std::size_t> own = counts.find({"interval_overlap", "f32", "cuda-fma", ""});
  const bool compares_own = own && counts.lanes[*own].cpu;
  return fmt::format(
      "On the 2012 thesis's triangles{} the GPU differs most from the CPU in {}: on {} of {} pairs{}{}.{}", in_doubles,
      counts.lanes[most].id, with_interval(share_of(differing(most), stratum->pairs)), pairs,
      compares_own && *own != most ? fmt::format("; in the thesis's own algorithm, interval_overlap/f32, on {}",
                                                 with_interval(share_of(differing(*own), stratum->pairs)))
                                   : "",
      !ran_without ? ""
      : without_contraction == 0
          ? "; without contraction on none"
          : fmt::format("; without contraction {} verdicts still differ", grouped(without_contraction)),
      in_float32 && compares_own ? kRateOf2012 : "");
}

std::string dangerous(const CampaignCounts& counts, const LaneIndices& lanes) {
  struct Danger {
    const StratumCounts* stratum;
    double share;
    std::size_t best;
    bool all_count;  // whether no verdict was declined or excused by a convention
  };
  std::vector<Danger> all;
  for (const StratumCounts& stratum : counts.strata) {
    if (stratum.pairs == 0) continue;
    double wrong = 0;
    for (const std::size_t l : lanes) wrong += static_cast<double>(stratum.wrong(l));
    const std::size_t best = *std::min_element(lanes.begin(), lanes.end(), [&](std::size_t l, std::size_t r) {
      return stratum.lanes[l].not_true() < stratum.lanes[r].not_true();
    });
    const bool all_count = std::all_of(lanes.begin(), lanes.end(), [&](std::size_t l) {
      return stratum.lanes[l].declined + stratum.lanes[l].by_convention == 0;
    });
    all.push_back(
        {&stratum, wrong / static_cast<double>(stratum.pairs) / static_cast<double>(lanes.size()), best, all_count});
  }
  std::stable_sort(all.begin(), all.end(), [](const Danger& l, const Danger& r) { return l.share > r.share; });
  const char* whose = lanes.size() < counts.lanes.size() ? "the published lanes' verdicts" : "all verdicts";
  const auto described = [&](const Danger& d) {
    const double best = share_of(d.stratum->wrong(d.best), d.stratum->pairs).share;
    const analysis::LaneCounts& of = d.stratum->lanes[d.best];
    const std::string declined = of.declined == 0 ? "" : ", which declines " + grouped(of.declined),
                      by_convention =
                          of.by_convention == 0 ? "" : ", whose convention allows " + grouped(of.by_convention);
    return fmt::format(
        "{} ({} of {} wrong{})", d.stratum->id, rate_words(d.share), whose,
        lanes.size() == 1 ? ""
                          : fmt::format(", {} of those of its best lane, {}{}{}", best == 0 ? "none" : rate_words(best),
                                        counts.lanes[d.best].id, declined, by_convention));
  };
  if (all.front().share == 0) {
    return all.size() == 1 ? fmt::format("The only stratum, {}, shows no wrong verdict.", all[0].stratum->id)
                           : fmt::format("None of the {} strata shows a wrong verdict.", all.size());
  }
  if (all.size() == 1) return fmt::format("The only stratum is {}.", described(all[0]));
  std::vector<std::string> worst;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, all.size() - 1) && all[i].share > 0; ++i)
    worst.push_back(described(all[i]));
  std::string text =
      fmt::format("The most dangerous {} {}", worst.size() == 1 ? "stratum is" : "strata are", list_of(worst));
  const auto worst_of_all = all.rend() - static_cast<std::ptrdiff_t>(worst.size());
  const auto safest = std::find_if(all.rbegin(), worst_of_all, std::mem_fn(&Danger::all_count));
  if (safest != worst_of_all)
    text += fmt::format("; the safest{} is {} ({})", safest == all.rbegin() ? "" : " on which every verdict counts",
                        safest->stratum->id, safest->share == 0 ? "no wrong verdict" : rate_words(safest->share));
  return text + '.';
}

}  // namespace

std::string rate_words(double rate, Bound bound) {
  if (rate == 0) return "0";
  const bool in_percent = rate >= 0.001;
  const double shown = in_percent ? 100 * rate : 1 / rate;
  std::string text = fmt::format("{:.3g}", shown);
  if (bound != Bound::none) {
    const bool up = (bound == Bound::upper) == in_percent;
    const auto outward = [&](double value) { return up ? rounded_up(value, 3) : rounded_down(value, 3); };
    text = outward(shown);
    // The product and the quotient above round as well, so the text is parsed and checked.
    const double read = in_percent ? std::stod(text) / 100 : 1 / std::stod(text);
    if (bound == Bound::upper ? read < rate : read > rate)
      text = outward(std::nextafter(std::stod(text), up ? HUGE_VAL : 0.0));
  }
  if (in_percent) return text + " %";
  return fmt::format("1 in {}", grouped(static_cast<std::uint64_t>(std::stod(text))));
}

std::string rate_words(std::uint64_t count, std::uint64_t of) { return rate_words(share_of(count, of).share); }

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
  if (found.failed() > 0) text += fmt::format(", {} without an answer", grouped(found.failed()));
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
      lanes.begin(), lanes.end(), [&](auto l, auto r) { return not_true(counts, l) < not_true(counts, r); });
  const std::optional<Cost> better = cost_of(costs, least, ground.strata);
  if (own && better && is_cheaper(*better, *own)) {
    text += fmt::format(". {} is both less often wrong and cheaper, {} {} against {}", counts.lanes[least].id,
                        cost_words(*better), ground.pair, cost_words(*own));
  }
  return {text + "."};
}

// If some lanes decline pairs, or differ by their convention, the sentence names the lane that is right most often,
// which is never one that declines everything.
Sentence least_wrong_lane(const CampaignCounts& counts, const Costs* costs) {
  const LaneIndices lanes = published(counts);
  const StratumCounts& total = counts.total;
  const auto less = [&](std::size_t l, std::size_t r) { return not_true(counts, l) < not_true(counts, r); };
  const std::size_t least = *std::min_element(lanes.begin(), lanes.end(), less);
  // The smallest number of pairs that any of these lanes decides; 0 if a convention excuses some, because nothing
  // counts the pairs that it does not cover.
  const auto decided = [&](const LaneIndices& of) {
    std::uint64_t pairs = total.pairs;
    for (const std::size_t l : of)
      pairs = std::min(pairs, total.lanes[l].by_convention > 0 ? 0 : total.pairs - total.lanes[l].declined);
    return pairs;
  };
  const bool any_not_counted = decided(lanes) < total.pairs;
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
                        not_counted(counts, lanes))};
  }
  const char* which = any_not_counted ? "most often right" : "least wrong";
  const std::optional<std::size_t> next = first_of_others(counts, lanes, least, less);
  if (next && !share_not_true(counts, least).apart(share_not_true(counts, *next)))
    return {not_settled(counts, which, least, *next, share_not_true,
                        any_not_counted ? "without a correct verdict" : "wrong")};
  const LaneIndices best = those(lanes, [&](std::size_t l) {
    return not_true(counts, l) == not_true(counts, least) && total.wrong(l) == total.wrong(least);
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
                        not_counted(counts, lanes))};
  return {fmt::format("Of the {} published lanes the {} {} {}: {}on {}{}{}.", lanes.size(), which,
                      best.size() == 1 ? "is" : "are", ids(counts, best), any_not_counted ? "wrong " : "", found, cost,
                      not_counted(counts, best))};
}

std::vector<std::string> answer(const CampaignCounts& counts, const Costs* costs, const nlohmann::ordered_json& kinds) {
  if (counts.total.pairs == 0) return {"No pair has been decided yet."};
  const LaneIndices lanes = published(counts);
  if (lanes.empty()) {
    std::uint64_t wrong = 0;
    for (std::size_t l = 0; l < counts.lanes.size(); ++l) wrong += counts.total.wrong(l);
    return {fmt::format("Only exact lanes ran, and {} of their verdicts on {} pairs {} wrong.",
                        wrong == 0 ? "none" : grouped(wrong), grouped(counts.total.pairs), wrong == 1 ? "is" : "are")};
  }
  std::vector<std::string> said = own_code_answer(counts, kinds), not_known;
  const bool ours = all_published(counts);
  const auto add = [&](Sentence sentence) {
    // A user's own code is inexact too, but it is not published.
    constexpr std::string_view kOurs = "published lane";
    for (std::size_t at; !ours && (at = sentence.text.find(kOurs)) != std::string::npos;)
      sentence.text.replace(at, kOurs.size(), "inexact lane");
    (sentence.known ? said : not_known).push_back(std::move(sentence.text));
  };
  add(lane_to_use(counts, costs));
  const bool compares =
      std::any_of(lanes.begin(), lanes.end(), [&](std::size_t l) { return !same_family(counts, l, lanes.front()); });
  if (ours || compares) {  // if only one own code ran, the first sentences cover this
    add(lane_to_avoid(counts, costs));
    add(least_wrong_lane(counts, costs));
  }
  add({dangerous(counts, lanes)});
  add({contraction(counts, lanes), !contracted(counts, lanes).empty()});
  const StratumCounts* drawn = counts.stratum("thesis");
  add({thesis(counts, lanes), drawn && drawn->pairs != 0});
  said.insert(said.end(), not_known.begin(), not_known.end());
  return said;
}

}  // namespace graze::reports
