// SPDX-License-Identifier: Apache-2.0
#include "cli/changed.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "analysis/verdicts_apart.h"
#include "cli/commands.h"
#include "core/simplify/simplicity.h"
#include "fuzz/campaign/changed_verdicts.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/minimise/kinds.h"
#include "reports/comparison.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

using fuzz::ChangedVerdicts;

// Finds a subject's lane, with the code that the campaign ran. Opens that code under a name that no user can give.
// Returns: null if the code no longer exists.
class RecordedCode {
 public:
  RecordedCode(const std::string& directory, std::string suffix)
      : subjects_(fuzz::recorded_spec(directory).value("subjects", Json::array())), suffix_(std::move(suffix)) {}

  const Lane* lane(const std::string& id) {
    LaneName name = parse_lane_name(id).value();
    for (const Json& row : subjects_) {
      if (row.at("name") != name.subject) continue;
      const std::string other_name = name.subject + suffix_;
      if (gone_.contains(other_name)) return nullptr;
      if (!subjects::opened(other_name) && !subjects::open_kept(row, other_name)) {
        gone_.insert(other_name);
        return nullptr;
      }
      name.subject = other_name;
      return find_lane(id_of(name));
    }
    return nullptr;
  }

 private:
  Json subjects_;
  std::string suffix_;
  std::set<std::string> gone_;  // names of subjects whose code no longer exists
};

// scene: "@" and the name of the scene, or empty.
Json case_json(const strata::PairSource& source, const std::string& scene, std::uint64_t seed, std::uint64_t index) {
  return fmt::format("{}{}:{}:{} {}", source.id, scene, seed, index, fuzz::pair_text(source.any_pair(index)));
}

// Decides the pairs of the rows' strata again with both lanes, and adds the counts to the rows.
void count_on_pairs(const Lane& before, const Lane& after, const std::vector<strata::PairSource>& sources,
                    const Json& spec, const std::vector<Json*>& rows) {
  const std::string scene = spec.contains("scene") ? '@' + spec["scene"].at("name").get<std::string>() : std::string();
  std::vector<strata::PairSource> of_rows;
  for (const Json* row : rows)
    of_rows.push_back(*std::find_if(sources.begin(), sources.end(),
                                    [&](const strata::PairSource& source) { return row->at("stratum") == source.id; }));
  const std::vector<analysis::VerdictsApart> found =
      analysis::verdicts_apart({{&before, &after}, {before.decide, after.decide}}, of_rows, 0, is_simpler);
  for (std::size_t s = 0; s < rows.size(); ++s) {
    Json& row = *rows[s];
    // If the count is outside the bounds, the code now answers differently, and the count is not used.
    if (found[s].differs < row["least"] || found[s].differs > row["most"]) continue;
    row["least"] = row["most"] = found[s].differs;
    row["broken"] = found[s].broken;
    row["mended"] = found[s].mended;
    for (const auto& [key, place] :
         {std::pair("smallest_broken", found[s].simplest_broken), {"smallest_mended", found[s].simplest_mended}})
      if (place) row[key] = case_json(of_rows[s], scene, spec.at("seed"), place->index);
  }
}

}  // namespace

Json changed_rows(const std::string& before, const std::string& after) {
  if (!fuzz::has_database(before) || !fuzz::has_database(after)) return nullptr;
  Json rows = Json::array();
  for (const ChangedVerdicts& found : fuzz::changed_verdicts(before, after)) {
    const char* known = found.known == ChangedVerdicts::Known::same      ? "same"
                        : found.known == ChangedVerdicts::Known::changed ? "changed"
                                                                         : "unknown";
    rows.push_back({{"lane", found.lane},
                    {"stratum", found.stratum},
                    {"pairs", found.pairs},
                    {"known", known},
                    {"least", found.least},
                    {"most", found.most}});
  }
  RecordedCode then(before, "@before"), now(after, "@after");
  const Json spec = fuzz::recorded_spec(after);
  std::map<std::string, std::vector<Json*>> of_lanes;
  for (Json& row : rows) {
    if (row.at("known") != "same") of_lanes[row.at("lane")].push_back(&row);
  }
  std::vector<strata::PairSource> sources;
  for (const auto& [id, changed] : of_lanes) {
    const Lane *lane_then = then.lane(id), *lane_now = lane_then ? now.lane(id) : nullptr;
    if (!lane_then || !lane_now || !lane_then->decide || !lane_now->decide) continue;
    if (sources.empty()) sources = fuzz::recorded_sources(spec);
    count_on_pairs(*lane_then, *lane_now, sources, spec, changed);
  }
  return rows;
}

void print_comparison(const Json& compare) {
  fmt::print("{}\n", compare["headline"].get<std::string>());
  for (const std::string& sentence : reports::changed_sentences(compare)) fmt::print("{}\n", sentence);
  for (const Json& sentence : compare["differences"]) fmt::print("{}\n", sentence.get<std::string>());
}

}  // namespace graze::cli
