// SPDX-License-Identifier: Apache-2.0
#include "reports/counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "fuzz/counts_json.h"
#include "strata/groups.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

ReportLane lane_of(const std::string& id) {
  const LaneName name = parse_lane_name(id).value_or(LaneName{id, "", "", ""});
  ReportLane lane{id, name};
  lane.row = find_lane(id);
  lane.exact = lane.row && lane.row->exact;
  return lane;
}

// Adds a row {"pairs", "wrong": {lane: count}, "differs_from_cpu": {lane: count}}.
void add(WrongCounts& counts, const Json& row, const std::map<std::string, std::size_t>& place) {
  counts.pairs += row.at("pairs").get<std::uint64_t>();
  for (const auto& [field, sums] :
       {std::pair("wrong", &counts.wrong), std::pair("differs_from_cpu", &counts.differs_from_cpu)}) {
    sums->resize(place.size());
    for (const auto& [lane, count] : row.at(field).items()) (*sums)[place.at(lane)] += count.get<std::uint64_t>();
  }
}

void add(StratumCounts& counts, const Json& row, bool in_doubles, const std::map<std::string, std::size_t>& place) {
  counts.lanes.resize(place.size());
  counts.pairs += row.at("pairs").get<std::uint64_t>();
  counts.intersects += row.at("intersects").get<std::uint64_t>();
  for (const auto& [lane, found] : row.at("lanes").items()) {
    const Json& differs = found.at("differs_from_cpu");  // null if nothing was compared
    counts.lanes[place.at(lane)] += {fuzz::counts_of(found), differs.is_null() ? 0 : differs.get<std::uint64_t>(),
                                     found.value("stored", std::uint64_t{0})};
  }
  for (const auto& [bucket, found] : row.at("margins").items())
    add(counts.margins[buckets_by_name().at(bucket)], found, place);
  if (!row.contains("extremes")) return;
  for (const auto& [axis, cells] : row["extremes"].items()) {
    std::map<int, WrongCounts>& counted = counts.extremes[axis + (in_doubles ? std::string(strata::kInDoubles) : "")];
    for (const auto& [exponent, found] : cells.items()) add(counted[std::stoi(exponent)], found, place);
  }
}

}  // namespace

const std::map<std::string, Bucket>& buckets_by_name() {
  static const std::map<std::string, Bucket> buckets = [] {
    std::map<std::string, Bucket> all;
    for (int b = -kBucketMost; b <= kBucketMost; ++b)
      all[name_of_bucket(static_cast<Bucket>(b))] = static_cast<Bucket>(b);
    return all;
  }();
  return buckets;
}

std::optional<std::size_t> CampaignCounts::find(const LaneName& name) const {
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (lanes[l].name == name) return l;
  }
  return {};
}

std::optional<std::size_t> CampaignCounts::counterpart(std::size_t lane, std::string_view variant) const {
  LaneName name = lanes[lane].name;
  name.variant = variant;
  return find(name);
}

const StratumCounts* CampaignCounts::stratum(std::string_view id) const {
  const auto found = std::find_if(strata.begin(), strata.end(), [&](const StratumCounts& s) { return s.id == id; });
  return found == strata.end() ? nullptr : &*found;
}

const GroupCounts* CampaignCounts::group(std::string_view id) const {
  const auto found = std::find_if(groups.begin(), groups.end(), [&](const GroupCounts& g) { return g.id == id; });
  return found == groups.end() ? nullptr : &*found;
}

std::vector<std::size_t> CampaignCounts::drawn() const {
  std::vector<std::size_t> places;
  for (std::size_t s = 0; s < strata.size(); ++s) {
    if (strata[s].pairs != 0) places.push_back(s);
  }
  return places;
}

CampaignCounts counts_of(const Json& summary) {
  CampaignCounts counts;
  counts.seed = summary.at("spec").at("seed");
  counts.pairs = summary.at("spec").at("pairs");
  counts.complete = summary.at("complete");
  std::map<std::string, std::size_t> place;
  for (const Json& id : summary.at("spec").at("lanes")) {
    place.emplace(id.get<std::string>(), counts.lanes.size());
    counts.lanes.push_back(lane_of(id));
  }
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    if (counts.lanes[l].name.variant != name(Variant::cpu))
      counts.lanes[l].cpu = counts.counterpart(l, name(Variant::cpu));
  }
  counts.total.lanes.resize(counts.lanes.size());
  for (const auto& [id, row] : summary.at("strata").items()) {
    StratumCounts& stratum = counts.strata.emplace_back();
    stratum.id = id;
    add(stratum, row, stratum.in_doubles(), place);
    add(counts.total, row, stratum.in_doubles(), place);
  }
  const auto doubles =
      std::count_if(counts.strata.begin(), counts.strata.end(), std::mem_fn(&StratumCounts::in_doubles));
  for (ReportLane& lane : counts.lanes)
    // On a pair of doubles, exact/f32 decides the pair rounded to float32.
    lane.exact = lane.exact && (doubles == 0 || lane.row->scalar == Scalar::f64);
  // Strata of doubles form separate groups if the campaign also has strata of float32.
  for (const bool of_doubles : {false, true}) {
    const bool apart = of_doubles && doubles != std::ssize(counts.strata);
    for (const strata::GroupInfo& info : strata::kGroups) {
      GroupCounts group{
          std::string(info.id) + (apart ? std::string(strata::kInDoubles) : ""),
          info.group == strata::Group::mesh ? std::string(info.what) : described(info.what, apart, summary.at("spec")),
          {},
          {}};
      for (std::size_t s = 0; s < counts.strata.size(); ++s) {
        const std::string& id = counts.strata[s].id;
        if (strata::group_of_name(id) != info.group || counts.strata[s].pairs == 0 ||
            counts.strata[s].in_doubles() != of_doubles)
          continue;
        group.strata.push_back(s);
        add(group.counts, summary["strata"][id], of_doubles, place);
      }
      if (!group.strata.empty()) counts.groups.push_back(std::move(group));
    }
  }
  return counts;
}

std::string described(std::string_view drawn, bool in_doubles, const Json& spec) {
  const std::string type = in_doubles ? "in doubles: " : "";
  if (!spec.contains("scene")) return type + std::string(drawn);
  return fmt::format("{}without a scene, {}; here with the sizes, shapes and positions that the scene allows", type,
                     drawn);
}

}  // namespace graze::reports
