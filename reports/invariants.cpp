// SPDX-License-Identifier: Apache-2.0
#include "reports/invariants.h"

#include <fmt/format.h>

#include <sstream>

#include "corpus/pair_format.h"
#include "reports/plain_figures.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using analysis::InvariantCase;
using analysis::InvariantCount;
using analysis::InvariantInfo;
using analysis::kInvariants;
using Json = nlohmann::ordered_json;

const std::optional<InvariantCase>& case_of(const analysis::InvariantsOfLane& lane, const InvariantInfo& invariant) {
  return lane.simplest[static_cast<std::size_t>(invariant.invariant)];
}

std::string place_of(const analysis::InvariantSpec& spec, const InvariantCase& found) {
  const strata::PairSource& source = spec.sources[static_cast<std::size_t>(found.place.source)];
  return fmt::format("pair {} of {}{}", found.place.index, source.id,
                     source.in_doubles() && found.pair.floats ? ", stored in float32" : "");
}

Json case_json(const analysis::InvariantSpec& spec, const std::optional<InvariantCase>& found) {
  if (!found) return nullptr;
  return {{"from", place_of(spec, *found)},
          {"pair", coordinates_of(found->pair)},
          {"says", name(found->of_pair)},
          {"image", coordinates_of(found->image)},
          {"says_of_image", name(found->of_image)}};
}

// The two entries of a case, the wrongly decided pair first.
std::vector<corpus::Entry> entries_of(const analysis::InvariantSpec& spec, const Lane& lane,
                                      const InvariantInfo& invariant, const InvariantCase& found) {
  const auto entry = [&](const AnyPair& pair, Verdict says, const std::string& from) {
    const Verdict truth = visit(pair, [&](const auto& own) { return decide_one(spec.exact, own); });
    return corpus::entry_of(pair, {{"invariant", std::string(invariant.id)},
                                   {"lanes", lane.id},
                                   {"from", from},
                                   {"says", std::string(name(says))},
                                   {"truth", std::string(name(truth))}});
  };
  const std::string from = place_of(spec, found);
  std::vector<corpus::Entry> entries = {entry(found.pair, found.of_pair, from),
                                        entry(found.image, found.of_image, "image of " + from)};
  if (corpus::text_of(entries[0], "says") == corpus::text_of(entries[0], "truth")) std::swap(entries[0], entries[1]);
  return entries;
}

// Tabulates what each power of two adds to the column "scale, in range". Empty if unknown or if no verdict changes.
std::string scales_table(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants,
                         const Screen& screen) {
  std::vector<Column> columns{{"lane", Align::left}};
  for (const int k : analysis::kScales) columns.push_back({fmt::format("2^{}", k)});
  TextTable table(columns);
  bool any = false;
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    if (invariants.lanes[l].total(analysis::Invariant::scale).in_range == 0) continue;
    any = true;
    std::vector<Cell> cells{spec.lanes[l]->id};
    for (const InvariantCount& count : invariants.lanes[l].by_scale)
      cells.emplace_back(count.pairs == 0 ? "-" : bare_percent(count.in_range, count.pairs), count.in_range > 0);
    table.add(std::move(cells));
  }
  if (!any) return "";
  return wrapped("Scale, in range, for each factor, in % of the pairs that it scales without losing a bit:",
                 screen.columns) +
         table.text(screen);
}

}  // namespace

std::string invariants_table(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants,
                             const Screen& screen) {
  std::vector<Column> columns{{"lane", Align::left}};
  for (const InvariantInfo& invariant : kInvariants) {
    columns.push_back({std::string(invariant.id)});
    if (invariant.invariant == analysis::Invariant::scale) columns.push_back({"scale, in range"});
  }
  TextTable table(columns);
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    std::vector<Cell> cells{spec.lanes[l]->id};
    for (const InvariantInfo& invariant : kInvariants) {
      const InvariantCount count = invariants.lanes[l].total(invariant.invariant);
      cells.emplace_back(count.pairs == 0 ? "-" : bare_percent(count.changed, count.pairs), count.changed > 0);
      if (invariant.invariant != analysis::Invariant::scale) continue;
      const bool known = analysis::knows_range(*spec.lanes[l]) || count.changed == 0;
      cells.emplace_back(count.pairs == 0 || !known ? "-" : bare_percent(count.in_range, count.pairs),
                         count.in_range > 0);
    }
    table.add(std::move(cells));
  }
  return wrapped(
             "Pairs on which the lane's verdict contradicts its verdict on some image, in % of the pairs that have an "
             "image (part: a part of a triangle intersects, but the whole is disjoint; in range: nothing over- or "
             "underflows).",
             screen.columns) +
         table.text(screen) + scales_table(spec, invariants, screen);
}

std::vector<std::string> invariants_sentences(const analysis::InvariantSpec& spec,
                                              const analysis::Invariants& invariants) {
  std::vector<std::string> sentences;
  std::map<std::string_view, std::string> claimed;
  for (const Lane* lane : spec.lanes) {
    if (claimed.contains(lane->info->id)) continue;
    for (const InvariantInfo& invariant : kInvariants) {
      if (analysis::claims(*lane, invariant.invariant))
        claimed[lane->info->id] += (claimed[lane->info->id].empty() ? "" : ", ") + std::string(invariant.id);
    }
    if (claimed[lane->info->id].empty()) claimed.erase(lane->info->id);
  }
  if (!claimed.empty()) {
    std::string text;
    for (const auto& [algorithm, names] : claimed)
      text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", algorithm, names);
    sentences.push_back(
        "Algorithms claim these invariants for lanes that round each operation as written. Those lanes kept them on "
        "every pair on which nothing over- or underflows: " +
        text + ".");
  }
  sentences.push_back(fmt::format(
      "exact breaks no invariant on {} pairs and their {} images; CGAL and GMP break none on {} of the pairs and "
      "their {} images.",
      grouped(invariants.pairs), grouped(invariants.images), grouped(invariants.by_oracle),
      grouped(invariants.its_images)));
  return sentences;
}

Json invariants_json(const analysis::InvariantSpec& spec, const analysis::Invariants& invariants) {
  Json what = Json::object(), lanes = Json::array();
  for (const InvariantInfo& invariant : kInvariants) what[std::string(invariant.id)] = invariant.what;
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    const analysis::InvariantsOfLane& lane = invariants.lanes[l];
    const bool knows_range = analysis::knows_range(*spec.lanes[l]);
    Json of_invariants = Json::object();
    for (const InvariantInfo& invariant : kInvariants) {
      Json strata = Json::object();
      for (std::size_t s = 0; s < spec.sources.size(); ++s) {
        const InvariantCount& count = lane.counts[static_cast<std::size_t>(invariant.invariant)][s];
        strata[spec.sources[s].id] = {{"pairs", count.pairs}, {"changed", count.changed}};
      }
      const InvariantCount all = lane.total(invariant.invariant);
      Json factors = Json::array();
      for (std::size_t k = 0; invariant.invariant == analysis::Invariant::scale && k < analysis::kScales.size(); ++k) {
        const InvariantCount& count = lane.by_scale[k];
        factors.push_back({{"log2", analysis::kScales[k]},
                           {"pairs", count.pairs},
                           {"changed", count.changed},
                           {"in_range", knows_range ? Json(count.in_range) : Json()}});
      }
      of_invariants[std::string(invariant.id)] = {{"claimed", analysis::claims(*spec.lanes[l], invariant.invariant)},
                                                  {"pairs", all.pairs},
                                                  {"changed", all.changed},
                                                  {"in_range", knows_range ? Json(all.in_range) : Json()},
                                                  {"strata", strata},
                                                  {"case", case_json(spec, case_of(lane, invariant))}};
      if (!factors.empty()) of_invariants[std::string(invariant.id)]["by_factor"] = factors;
    }
    lanes.push_back({{"lane", spec.lanes[l]->id}, {"invariants", of_invariants}});
  }
  return {{"invariants", what},
          {"truth",
           {{"pairs", invariants.pairs},
            {"images", invariants.images},
            {"by_oracle", invariants.by_oracle},
            {"its_images", invariants.its_images}}},
          {"lanes", lanes}};
}

std::map<std::string, std::string> invariants_cases(const analysis::InvariantSpec& spec,
                                                    const analysis::Invariants& invariants) {
  std::map<std::string, std::string> files;
  for (const InvariantInfo& invariant : kInvariants) {
    std::ostringstream text;
    corpus::write_header(text);
    bool any = false;
    for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
      const std::optional<InvariantCase>& found = case_of(invariants.lanes[l], invariant);
      if (!found) continue;
      any = true;
      for (const corpus::Entry& entry : entries_of(spec, *spec.lanes[l], invariant, *found))
        corpus::write_entry(text, entry);
    }
    if (any) files[std::string(invariant.id) + ".pairs"] = text.str();
  }
  return files;
}

}  // namespace graze::reports
