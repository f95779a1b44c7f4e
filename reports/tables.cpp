// SPDX-License-Identifier: Apache-2.0
#include "reports/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/text.h"
#include "fuzz/counts_json.h"
#include "reports/extremes.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kDigits = 5;

double rounded(double value) { return *parse_float64(fmt::format("{:.{}g}", value, kDigits)); }

// Calls visit(index, stratum) for each stratum that has pairs, then visit(null, total).
template <class Visit>
void for_each_stratum(const CampaignCounts& counts, Visit visit) {
  for (std::size_t s = 0; s < counts.strata.size(); ++s) {
    if (counts.strata[s].pairs != 0) visit(Json(s), counts.strata[s]);
  }
  if (counts.total.pairs != 0) visit(Json(), counts.total);
}

Json wrong_of(const StratumCounts& stratum, std::size_t lane) {
  return to_json(share_of(stratum.wrong(lane), stratum.pairs));
}

// The shares of a lane's errors: false positives among the disjoint pairs, false negatives among the intersecting
// pairs, and all wrong verdicts.
Json errors_of(const StratumCounts& pairs, std::size_t lane) {
  const analysis::LaneCounts& found = pairs.lanes[lane];
  return {{"false_positive", to_json(share_of(found.false_positive, pairs.pairs - pairs.intersects))},
          {"false_negative", to_json(share_of(found.false_negative, pairs.intersects))},
          {"wrong", wrong_of(pairs, lane)}};
}

}  // namespace

Json to_json(const Share& share) {
  // Without pairs to count, there is no share.
  if (share.of == 0) return {{"count", 0}, {"of", 0}, {"share", nullptr}, {"low", nullptr}, {"high", nullptr}};
  return share_json(share);
}

Json share_json(const Share& share) {
  return {{"count", share.count},
          {"of", share.of},
          {"share", rounded(share.share)},
          {"low", std::stod(rounded_down(share.low, kDigits))},
          {"high", std::stod(rounded_up(share.high, kDigits))}};
}

Json rates(const CampaignCounts& counts) {
  Json rows = Json::array();
  const bool any_doubles =
      std::any_of(counts.strata.begin(), counts.strata.end(), std::mem_fn(&StratumCounts::in_doubles));
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    for_each_stratum(counts, [&](const Json& place, const StratumCounts& stratum) {
      const analysis::LaneCounts& lane = stratum.lanes[l];
      rows.push_back({{"lane", l}, {"stratum", place}});
      rows.back().update(errors_of(stratum, l));
      rows.back().update({{"declined", lane.declined}, {"differs_from_cpu", nullptr}});
      if (counts.lanes[l].cpu)
        rows.back()["differs_from_cpu"] = to_json(share_of(lane.differs_from_cpu, stratum.pairs));
      if (counts.lanes[l].name.scalar == "f32" && (place.is_null() ? any_doubles : stratum.in_doubles()))
        rows.back()["stored"] = lane.stored;
      if (!lane.any_foreign()) return;
      for (const fuzz::CountField& field : fuzz::kCountFields) {
        if (field.foreign) rows.back()[field.key] = lane.*field.count;
      }
    });
  }
  return rows;
}

std::optional<std::uint64_t> differs(const CampaignCounts& counts, const StratumCounts& stratum, std::size_t left,
                                     std::size_t right) {
  const auto left_cpu = counts.lanes[left].cpu, right_cpu = counts.lanes[right].cpu;
  // A lane that never differs from the cpu lane can take the cpu lane's place in the comparison.
  const bool stands_for_cpu = left_cpu && left_cpu == right_cpu && stratum.lanes[left].differs_from_cpu == 0;
  if (right_cpu != left && !stands_for_cpu) return std::nullopt;
  return stratum.lanes[right].differs_from_cpu;
}

Json side_by_side(const CampaignCounts& counts) {
  Json rows = Json::array();
  const auto add = [&](const char* kind, std::size_t left, std::optional<std::size_t> right) {
    if (!right) return;
    Json strata = Json::array();
    for_each_stratum(counts, [&](const Json& place, const StratumCounts& stratum) {
      const std::optional<std::uint64_t> count = differs(counts, stratum, left, *right);
      strata.push_back({{"stratum", place},
                        {"left_wrong", wrong_of(stratum, left)},
                        {"right_wrong", wrong_of(stratum, *right)},
                        {"differs", count ? to_json(share_of(*count, stratum.pairs)) : Json()}});
    });
    rows.push_back({{"kind", kind}, {"left", left}, {"right", *right}, {"strata", std::move(strata)}});
  };
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const ReportLane& lane = counts.lanes[l];
    if (lane.name.variant == name(Variant::cpu)) add("cpu-nofma", l, counts.counterpart(l, name(Variant::cuda_nofma)));
    if (lane.name.variant == name(Variant::cuda_nofma))
      add("nofma-fma", l, counts.counterpart(l, name(Variant::cuda_fma)));
    LaneName double_precision = lane.name;
    double_precision.scalar = name(Scalar::f64);
    if (lane.name.scalar == name(Scalar::f32)) add("f32-f64", l, counts.find(double_precision));
  }
  return rows;
}

Json margins(const CampaignCounts& counts) {
  Json rows = Json::array();
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    Json points = Json::array();
    for (const auto& [bucket, found] : counts.total.margins) {
      points.push_back({{"side", side_of(bucket)},
                        {"exponent", bucket == 0 ? Json() : Json(exponent_of(bucket))},
                        {"wrong", to_json(share_of(found.wrong[l], found.pairs))}});
      if (counts.lanes[l].cpu) points.back()["differs"] = to_json(share_of(found.differs_from_cpu[l], found.pairs));
    }
    rows.push_back({{"lane", l}, {"stratum", nullptr}, {"points", std::move(points)}});
  }
  return rows;
}

Threshold threshold(const StratumCounts& counts, std::size_t lane, int side) {
  Threshold result;
  for (int b = kBucketMost; b > 0; --b) {
    const auto found = counts.margins.find(static_cast<Bucket>(side * b));
    if (found == counts.margins.end() || found->second.pairs == 0) continue;
    if (!result.largest) result.largest = exponent_of(found->first);
    if (found->second.wrong[lane] != 0) {
      result.exponent = exponent_of(found->first) + 1;  // even if the buckets just above are empty
      break;
    }
    result = {true, exponent_of(found->first), result.above + found->second.pairs, result.largest};
  }
  return result;
}

Json to_json(const Threshold& t) {
  return {{"exponent", t.found ? Json(t.exponent) : Json()},
          {"above", t.above},
          {"bound", std::stod(rounded_up(bound_of_none(t.above), kDigits))},
          {"largest", t.largest ? Json(*t.largest) : Json()}};
}

Json thresholds(const CampaignCounts& counts) {
  Json rows = Json::array();
  const auto add = [&](const Json& group, const Json& stratum, const StratumCounts& of) {
    for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
      Json row = {{"lane", l}, {"group", group}, {"stratum", stratum}};
      for (const auto& [name, side] : {std::pair("disjoint", 1), std::pair("intersects", -1)}) {
        row[name] = to_json(threshold(of, l, side));
      }
      rows.push_back(std::move(row));
    }
  };
  for (std::size_t g = 0; g < counts.groups.size(); ++g) add(g, nullptr, counts.groups[g].counts);
  for_each_stratum(counts, [&](const Json& place, const StratumCounts& stratum) { add(nullptr, place, stratum); });
  return rows;
}

Json groups(const CampaignCounts& counts) {
  Json rows = Json::array();
  for (const GroupCounts& group : counts.groups)
    rows.push_back({{"id", group.id}, {"describes", group.describes}, {"strata", group.strata}});
  return rows;
}

Json group_rates(const CampaignCounts& counts) {
  Json rows = Json::array();
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    for (std::size_t g = 0; g < counts.groups.size(); ++g) {
      rows.push_back({{"lane", l}, {"group", g}});
      rows.back().update(errors_of(counts.groups[g].counts, l));
    }
  }
  return rows;
}

Json extremes(const CampaignCounts& counts) {
  Json rows = Json::array();
  for (const auto& [kind, cells] : counts.total.extremes) {
    const int step = width_of_place(kind == "scale"       ? Axis::scale
                                    : kind == "scale/f64" ? Axis::wide_scale
                                                          : Axis::offset);
    for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
      Json row = {{"kind", kind}, {"step", step}, {"lane", l}, {"cells", Json::array()}};
      for (const auto& [exponent, found] : cells) {
        if (found.pairs != 0)
          row["cells"].push_back({{"exponent", exponent}, {"wrong", to_json(share_of(found.wrong[l], found.pairs))}});
      }
      if (row["cells"].empty()) continue;
      add_right_range(row);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace graze::reports
