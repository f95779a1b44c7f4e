// SPDX-License-Identifier: Apache-2.0
#include "reports/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/text.h"
#include "reports/lane_words.h"
#include "reports/own_code.h"
#include "reports/recommendations.h"
#include "reports/tables.h"

namespace graze::reports {
namespace {

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
  };
  std::vector<Danger> all;
  for (const StratumCounts& stratum : counts.strata) {
    if (stratum.pairs == 0) continue;
    double wrong = 0;
    for (const std::size_t l : lanes) wrong += static_cast<double>(stratum.wrong(l));
    const std::size_t best = *std::min_element(lanes.begin(), lanes.end(), [&](std::size_t l, std::size_t r) {
      return stratum.lanes[l].not_right() < stratum.lanes[r].not_right();
    });
    all.push_back({&stratum, wrong / static_cast<double>(stratum.pairs) / static_cast<double>(lanes.size()), best});
  }
  std::stable_sort(all.begin(), all.end(), [](const Danger& l, const Danger& r) { return l.share > r.share; });
  const char* whose = lanes.size() < counts.lanes.size() ? "the published lanes' verdicts" : "all verdicts";
  const auto described = [&](const Danger& d) {
    const double best = share_of(d.stratum->wrong(d.best), d.stratum->pairs).share;
    const std::uint64_t declined = d.stratum->lanes[d.best].declined;
    return fmt::format("{} ({} of {} wrong{})", d.stratum->id, rate_words(d.share), whose,
                       lanes.size() == 1 ? ""
                                         : fmt::format(", {} of those of its best lane, {}{}",
                                                       best == 0 ? "none" : rate_words(best), counts.lanes[d.best].id,
                                                       declined == 0 ? "" : ", which declines " + grouped(declined)));
  };
  if (all.front().share == 0) {
    return all.size() == 1 ? fmt::format("The only stratum, {}, shows no wrong verdict.", all[0].stratum->id)
                           : fmt::format("None of the {} strata shows a wrong verdict.", all.size());
  }
  if (all.size() == 1) return fmt::format("The only stratum is {}.", described(all[0]));
  std::vector<std::string> worst;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, all.size() - 1) && all[i].share > 0; ++i)
    worst.push_back(described(all[i]));
  return fmt::format("The most dangerous {} {}; the safest is {} ({}).",
                     worst.size() == 1 ? "stratum is" : "strata are", list_of(worst), all.back().stratum->id,
                     all.back().share == 0 ? "no wrong verdict" : rate_words(all.back().share));
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
