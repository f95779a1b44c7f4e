// SPDX-License-Identifier: Apache-2.0
#include "reports/laws.h"

#include <fmt/format.h>

#include <sstream>

#include "corpus/pair_format.h"
#include "reports/plain_figures.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using analysis::kLaws;
using analysis::LawCase;
using analysis::LawCount;
using analysis::LawInfo;
using Json = nlohmann::ordered_json;

const std::optional<LawCase>& case_of(const analysis::LawsOfLane& lane, const LawInfo& law) {
  return lane.simplest[static_cast<std::size_t>(law.law)];
}

std::string place_of(const analysis::LawSpec& spec, const LawCase& found) {
  return fmt::format("pair {} of {}", found.place.index, spec.sources[static_cast<std::size_t>(found.place.source)].id);
}

Json case_json(const analysis::LawSpec& spec, const std::optional<LawCase>& found) {
  if (!found) return nullptr;
  return {{"from", place_of(spec, *found)},
          {"pair", coordinates_of(found->pair)},
          {"says", name(found->of_pair)},
          {"image", coordinates_of(found->image)},
          {"says_of_image", name(found->of_image)}};
}

// The two entries of a case; the first is a pair on which the verdict is not the truth.
std::vector<corpus::Entry> entries_of(const analysis::LawSpec& spec, const Lane& lane, const LawInfo& law,
                                      const LawCase& found) {
  const auto entry = [&](const Pair& pair, Verdict says, const std::string& from) {
    const Verdict truth = decide_one(spec.exact, pair);
    return corpus::Entry{pair,
                         {{"law", std::string(law.id)},
                          {"lanes", lane.id},
                          {"from", from},
                          {"says", std::string(name(says))},
                          {"truth", std::string(name(truth))}}};
  };
  const std::string from = place_of(spec, found);
  std::vector<corpus::Entry> entries = {entry(found.pair, found.of_pair, from),
                                        entry(found.image, found.of_image, "image of " + from)};
  if (corpus::text_of(entries[0], "says") == corpus::text_of(entries[0], "truth")) std::swap(entries[0], entries[1]);
  return entries;
}

// How much of the column "scale, in range" each power of two makes alone; empty where nothing is known, or nothing is
// changed.
std::string scales_table(const analysis::LawSpec& spec, const analysis::Laws& laws, const Screen& screen) {
  std::vector<Column> columns{{"lane", Align::left}};
  for (const int k : analysis::kScales) columns.push_back({fmt::format("2^{}", k)});
  TextTable table(columns);
  bool any = false;
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    if (laws.lanes[l].total(analysis::Law::scale).in_range == 0) continue;
    any = true;
    std::vector<Cell> cells{spec.lanes[l]->id};
    for (const LawCount& count : laws.lanes[l].by_scale)
      cells.emplace_back(count.pairs == 0 ? "-" : bare_percent(count.in_range, count.pairs), count.in_range > 0);
    table.add(std::move(cells));
  }
  if (!any) return "";
  return wrapped("Scale, in range, by each factor alone, in % of the pairs that it scales without losing a bit:",
                 screen.columns) +
         table.text(screen);
}

}  // namespace

std::string laws_table(const analysis::LawSpec& spec, const analysis::Laws& laws, const Screen& screen) {
  std::vector<Column> columns{{"lane", Align::left}};
  for (const LawInfo& law : kLaws) {
    columns.push_back({std::string(law.id)});
    if (law.law == analysis::Law::scale) columns.push_back({"scale, in range"});
  }
  TextTable table(columns);
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    std::vector<Cell> cells{spec.lanes[l]->id};
    for (const LawInfo& law : kLaws) {
      const LawCount count = laws.lanes[l].total(law.law);
      cells.emplace_back(count.pairs == 0 ? "-" : bare_percent(count.changed, count.pairs), count.changed > 0);
      if (law.law != analysis::Law::scale) continue;
      const bool known = analysis::knows_range(*spec.lanes[l]) || count.changed == 0;
      cells.emplace_back(count.pairs == 0 || !known ? "-" : bare_percent(count.in_range, count.pairs),
                         count.in_range > 0);
    }
    table.add(std::move(cells));
  }
  return wrapped(
             "In % of the pairs that have an image: those on which the lane's verdict on some image is another one, "
             "although the question is the same (part: intersects, of a part of a triangle, where the whole is "
             "disjoint; in range: where nothing over- or underflows).",
             screen.columns) +
         table.text(screen) + scales_table(spec, laws, screen);
}

std::vector<std::string> laws_sentences(const analysis::LawSpec& spec, const analysis::Laws& laws) {
  std::vector<std::string> sentences;
  std::map<std::string_view, std::string> claimed;
  for (const Lane* lane : spec.lanes) {
    if (claimed.contains(lane->info->id)) continue;
    for (const LawInfo& law : kLaws) {
      if (analysis::claims(*lane, law.law))
        claimed[lane->info->id] += (claimed[lane->info->id].empty() ? "" : ", ") + std::string(law.id);
    }
    if (claimed[lane->info->id].empty()) claimed.erase(lane->info->id);
  }
  if (!claimed.empty()) {
    std::string text;
    for (const auto& [algorithm, names] : claimed)
      text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", algorithm, names);
    sentences.push_back(
        "Claimed by algorithms, of lanes that round each operation as written, and kept by them on every "
        "pair on which nothing over- or underflows: " +
        text + ".");
  }
  sentences.push_back(fmt::format(
      "exact breaks no law on {} pairs and their {} images; CGAL and GMP none on {} of the pairs and their {} images.",
      grouped(laws.pairs), grouped(laws.images), grouped(laws.by_oracle), grouped(laws.its_images)));
  return sentences;
}

Json laws_json(const analysis::LawSpec& spec, const analysis::Laws& laws) {
  Json what = Json::object(), lanes = Json::array();
  for (const LawInfo& law : kLaws) what[std::string(law.id)] = law.what;
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    const analysis::LawsOfLane& lane = laws.lanes[l];
    const bool knows_range = analysis::knows_range(*spec.lanes[l]);
    Json of_laws = Json::object();
    for (const LawInfo& law : kLaws) {
      Json strata = Json::object();
      for (std::size_t s = 0; s < spec.sources.size(); ++s) {
        const LawCount& count = lane.counts[static_cast<std::size_t>(law.law)][s];
        strata[spec.sources[s].id] = {{"pairs", count.pairs}, {"changed", count.changed}};
      }
      const LawCount all = lane.total(law.law);
      Json factors = Json::array();
      for (std::size_t k = 0; law.law == analysis::Law::scale && k < analysis::kScales.size(); ++k) {
        const LawCount& count = lane.by_scale[k];
        factors.push_back({{"log2", analysis::kScales[k]},
                           {"pairs", count.pairs},
                           {"changed", count.changed},
                           {"in_range", knows_range ? Json(count.in_range) : Json()}});
      }
      of_laws[std::string(law.id)] = {{"claimed", analysis::claims(*spec.lanes[l], law.law)},
                                      {"pairs", all.pairs},
                                      {"changed", all.changed},
                                      {"in_range", knows_range ? Json(all.in_range) : Json()},
                                      {"strata", strata},
                                      {"case", case_json(spec, case_of(lane, law))}};
      if (!factors.empty()) of_laws[std::string(law.id)]["by_factor"] = factors;
    }
    lanes.push_back({{"lane", spec.lanes[l]->id}, {"laws", of_laws}});
  }
  return {{"laws", what},
          {"truth",
           {{"pairs", laws.pairs},
            {"images", laws.images},
            {"by_oracle", laws.by_oracle},
            {"its_images", laws.its_images}}},
          {"lanes", lanes}};
}

std::map<std::string, std::string> laws_cases(const analysis::LawSpec& spec, const analysis::Laws& laws) {
  std::map<std::string, std::string> files;
  for (const LawInfo& law : kLaws) {
    std::ostringstream text;
    corpus::write_header(text);
    bool any = false;
    for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
      const std::optional<LawCase>& found = case_of(laws.lanes[l], law);
      if (!found) continue;
      any = true;
      for (const corpus::Entry& entry : entries_of(spec, *spec.lanes[l], law, *found)) corpus::write_entry(text, entry);
    }
    if (any) files[std::string(law.id) + ".pairs"] = text.str();
  }
  return files;
}

}  // namespace graze::reports
