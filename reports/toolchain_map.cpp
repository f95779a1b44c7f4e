// SPDX-License-Identifier: Apache-2.0
#include "reports/tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/variants.h"
#include "reports/findings.h"
#include "reports/terminal.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;
namespace {

// The lanes of one algorithm and scalar.
struct Row {
  std::string algorithm, scalar;
  std::vector<std::optional<std::size_t>> lanes;  // by variant
};

bool is_compared(const ReportLane& lane) { return !lane.exact && lane.name.policy.empty(); }

bool is_of_toolchain(const ReportLane& lane) {
  const std::optional<Variant> variant = variant_of_name(lane.name.variant);
  return is_compared(lane) && (!variant || info_of(*variant).runs_on == RunsOn::program);
}

std::vector<std::string> variants_of(const CampaignCounts& counts) {
  std::vector<std::string> found;
  for (const ReportLane& lane : counts.lanes) {
    if (is_compared(lane) && std::find(found.begin(), found.end(), lane.name.variant) == found.end())
      found.push_back(lane.name.variant);
  }
  return found;
}

std::vector<Row> rows_of(const CampaignCounts& counts, const std::vector<std::string>& variants) {
  std::vector<Row> rows;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const ReportLane& lane = counts.lanes[l];
    if (!is_compared(lane)) continue;
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
      return r.algorithm == lane.name.subject && r.scalar == lane.name.scalar;
    });
    if (row == rows.end()) {
      rows.push_back({lane.name.subject, lane.name.scalar, {}});
      row = rows.end() - 1;
      row->lanes.resize(variants.size());
    }
    row->lanes[static_cast<std::size_t>(std::find(variants.begin(), variants.end(), lane.name.variant) -
                                        variants.begin())] = l;
  }
  return rows;
}

bool is_counted(const analysis::LaneCounts& lane) { return lane.declined == 0 && lane.by_convention == 0; }

// Counts on how many pairs the verdicts of two lanes of one algorithm differ.
class Differences {
 public:
  Differences(const CampaignCounts& counts, const Json& signatures) : counts_(counts) {
    for (const Json& row : signatures)
      marks_[row.at("algorithm")].emplace_back(row.at("marks"), row.at("count").get<std::uint64_t>());
    std::map<std::string, std::size_t> next;
    for (const ReportLane& lane : counts.lanes) places_.push_back(next[lane.name.subject]++);
  }

  std::optional<std::uint64_t> between(std::size_t left, std::size_t right) const {
    if (!is_counted(counts_.total.lanes[left]) || !is_counted(counts_.total.lanes[right])) return std::nullopt;
    const auto found = marks_.find(counts_.lanes[left].name.subject);
    std::uint64_t sum = 0;
    if (found == marks_.end()) return sum;
    for (const auto& [marks, count] : found->second)
      sum += marks.at(places_[left]) == marks.at(places_[right]) ? 0 : count;
    return sum;
  }

 private:
  const CampaignCounts& counts_;
  std::map<std::string, std::vector<std::pair<std::string, std::uint64_t>>> marks_;  // by algorithm
  std::vector<std::size_t> places_;  // of each lane, among the lanes of its algorithm
};

// Whether two variants have the same lanes and these lanes agree on every pair.
bool agree(const std::vector<Row>& rows, const Differences& differences, std::size_t left, std::size_t right) {
  return std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
    if (!row.lanes[left] || !row.lanes[right]) return row.lanes[left] == row.lanes[right];
    return differences.between(*row.lanes[left], *row.lanes[right]) == 0;
  });
}

// The groups of at least two variants that agree.
std::vector<std::vector<std::string>> groups_of(const std::vector<Row>& rows, const std::vector<std::string>& variants,
                                                const Differences& differences) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& group) { return agree(rows, differences, group.front(), v); });
    if (found == groups.end()) {
      groups.push_back({v});
    } else {
      found->push_back(v);
    }
  }
  std::vector<std::vector<std::string>> names;
  for (const std::vector<std::size_t>& group : groups) {
    if (group.size() < 2) continue;
    names.emplace_back();
    for (const std::size_t v : group) names.back().push_back(variants[v]);
  }
  return names;
}

std::vector<std::string> sentences_of(const CampaignCounts& counts, const Json& map) {
  std::vector<std::string> sentences;
  for (const Json& group : map.at("agree")) {
    const std::vector<std::string> names = group;
    sentences.push_back(
        fmt::format("{} agree on all {}.", fmt::join(names, ", "), counted(counts.total.pairs, "pair")));
  }
  const Json* worst = nullptr;
  for (const Json& row : map.at("rows")) {
    for (const Json& cell : row.at("cells")) {
      if (!cell.at("differs").is_null() && (!worst || cell["differs"]["count"] > (*worst)["differs"]["count"]))
        worst = &cell;
    }
  }
  if (worst && (*worst)["differs"]["count"] > 0) {
    const Json& differs = (*worst)["differs"];
    sentences.push_back(
        fmt::format("{} differs most from {}: on {} ({}).", counts.lanes[(*worst)["lane"].get<std::size_t>()].id,
                    map.at("reference").get<std::string>(), counted(differs["count"].get<std::uint64_t>(), "pair"),
                    rate_words(differs["share"])));
  }
  return sentences;
}

}  // namespace

bool has_toolchains(const CampaignCounts& counts) {
  return std::any_of(counts.lanes.begin(), counts.lanes.end(), is_of_toolchain);
}

Json toolchain_map(const CampaignCounts& counts, const Json& signatures) {
  if (!has_toolchains(counts) || counts.total.pairs == 0) return nullptr;
  const std::vector<std::string> variants = variants_of(counts);
  const std::vector<Row> rows = rows_of(counts, variants);
  const Differences differences(counts, signatures);
  auto reference = std::find(variants.begin(), variants.end(), "x86-gcc");
  if (reference == variants.end()) reference = std::find(variants.begin(), variants.end(), name(Variant::cpu));
  if (reference == variants.end()) reference = variants.begin();
  const auto of = static_cast<std::size_t>(reference - variants.begin());
  Json map = {{"reference", *reference}, {"variants", variants}, {"rows", Json::array()}};
  for (const Row& row : rows) {
    Json cells = Json::array();
    for (std::size_t v = 0; v < variants.size(); ++v) {
      if (!row.lanes[v]) continue;
      const std::size_t lane = *row.lanes[v];
      const auto differ = row.lanes[of] ? differences.between(lane, *row.lanes[of]) : std::nullopt;
      cells.push_back({{"variant", v},
                       {"lane", lane},
                       {"differs", differ ? to_json(share_of(*differ, counts.total.pairs)) : Json()},
                       {"wrong", to_json(share_of(counts.total.wrong(lane), counts.total.pairs))}});
    }
    map["rows"].push_back({{"algorithm", row.algorithm}, {"scalar", row.scalar}, {"cells", std::move(cells)}});
  }
  map["agree"] = groups_of(rows, variants, differences);
  map["sentences"] = sentences_of(counts, map);
  return map;
}

}  // namespace graze::reports
