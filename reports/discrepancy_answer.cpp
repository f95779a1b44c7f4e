// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "analysis/tuning.h"
#include "core/text.h"
#include "reports/discrepancy.h"
#include "reports/discrepancy_reading.h"
#include "reports/findings.h"
#include "reports/terminal.h"
#include "reports/verdicts_apart.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// "1 in 3,330 (moller_1997/f32/cpu and cuda-fma)"
std::string extreme(const std::vector<const Json*>& lanes, const char* count, bool most) {
  const auto rate = [&](const Json* of) {
    return part_of(number_at(of->at("total"), count), number_at(of->at("total"), "pairs"));
  };
  const auto less = [&](const Json* l, const Json* r) { return rate(l) < rate(r); };
  const Json* of =
      most ? *std::max_element(lanes.begin(), lanes.end(), less) : *std::min_element(lanes.begin(), lanes.end(), less);
  return fmt::format("{} ({})", rate_words(rate(of)), text_at(*of, "second"));
}

// Describes on how many pairs a lane's verdict differs from that of its recorded run. Empty if there are none.
std::string unlike_words(const Json& json) {
  std::string text;
  for (const Json& of : json.at("lanes")) {
    for (int lane = 0; lane < 2; ++lane) {
      if (const std::uint64_t unlike = of.at("total").at("unlike").at(lane); unlike > 0)
        text += fmt::format(
            " On {} pairs the verdict of {} differs from that of its recorded run, which is compiled "
            "separately and counted here.",
            grouped(unlike), text_at(of, lane == 0 ? "first" : "second"));
    }
  }
  return text;
}

std::string shares_sentence(const std::vector<const Json*>& lanes, std::uint64_t same) {
  if (lanes.empty()) return "In every pair of lanes, all values that a comparison sees have the same bits.";
  if (lanes.size() == 1 && same == 0) {
    const Json &total = lanes[0]->at("total"), &distances = total.at("sites").at("plane_distance");
    const std::uint64_t pairs = number_at(total, "pairs");
    const auto rate = [&](const Json& of, const char* key) { return rate_words(number_at(of, key), pairs); };
    return fmt::format("Some value differs on {} of the pairs, some sign or choice on {}, and the verdict on {}.{}",
                       rate(total, "differs"), rate(total, "sign"), rate(total, "verdict"),
                       number_at(distances, "differs") == 0
                           ? ""
                           : fmt::format(" A signed distance differs on {}, its sign on {}.",
                                         rate(distances, "differs"), rate(distances, "sign")));
  }
  return fmt::format(
      "Of {} pairs of lanes, {} have the same bits in every value. In the others some value differs on {} to {} of the "
      "pairs of triangles, and the verdict on {} to {}.",
      lanes.size() + same, same, extreme(lanes, "differs", false), extreme(lanes, "differs", true),
      extreme(lanes, "verdict", false), extreme(lanes, "verdict", true));
}

// "core/vec3.h:48 within core/algorithms/plane.h:30"
std::string place_of(const Json& line) {
  const std::string within = text_at(line, "within");
  return text_at(line, "line") + (within.empty() ? "" : " within " + within);
}

std::string start_sentence(const std::vector<const Json*>& lanes) {
  std::map<std::string, std::uint64_t> starts;
  std::uint64_t all = 0, fixed = 0, changed = 0;
  bool traced = false;
  std::string top_line;
  for (const Json* of : lanes) {
    const Json& origins = of->at("origins");
    if (origins.is_null()) continue;
    traced = true;
    changed += number_at(origins, "verdicts");
    for (const Json& start : origins.at("starts")) {
      for (const auto& [line, count] : start.at("by_line").items()) {
        starts[place_of(origins.at("lines").at(static_cast<std::size_t>(std::stoul(line))))] +=
            count.get<std::uint64_t>();
        all += count.get<std::uint64_t>();
      }
      all += number_at(start, "by_several_lines");
    }
    for (const Json& line : origins.at("lines")) {
      if (number_at(line, "verdicts_fixed") > fixed) {
        fixed = number_at(line, "verdicts_fixed");
        top_line = fmt::format("{} of {}", place_of(line), text_at(*of, "second"));
      }
    }
  }
  if (all == 0 && traced) return "Contraction changes no value on the traced pairs.";
  if (all == 0) return "It is not known where differences start: no pair of lanes has contractions that can be traced.";
  const auto top =
      std::max_element(starts.begin(), starts.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
  return fmt::format("{} of the {} traced values that differ start to differ at {}.{}", rate_words(top->second, all),
                     grouped(all), top->first,
                     changed == 0 ? " No traced verdict changes."
                     : fixed == 0 ? " Leaving only one line's products unfused restores none of the verdicts that "
                                    "contraction changes."
                                  : fmt::format(" Leaving only the products of {} unfused restores {} of the verdicts "
                                                "that contraction changes; no other line restores more.",
                                                top_line, grouped(fixed)));
}

std::string nearer_sentence(const std::vector<const Json*>& lanes) {
  std::uint64_t first = 0, second = 0, equal = 0, unknown = 0;
  for (const Json* of : lanes) {
    auto sums = sum_by_bucket(of->at("total"), "nearer");
    first += sums["first"], second += sums["second"], equal += sums["equal"], unknown += sums["unknown"];
  }
  const std::uint64_t all = first + second + equal + unknown;
  if (all == 0) return "No value differs, so no lane is nearer to the exact values.";
  return fmt::format(
      "Of {} differing values, the second lane's is nearer to the exact one in {}, the first lane's in {}; {} are "
      "equally near, and for {} the certified bounds cannot decide.",
      grouped(all), rate_words(second, all), rate_words(first, all), grouped(equal), grouped(unknown));
}

// The bound counts pairs, not comparisons, because the dozens of comparisons on one pair are not independent.
std::string band_sentence(const std::vector<const Json*>& lanes, std::uint64_t pairs) {
  double widest = 0;
  std::uint64_t asked = 0, beyond_range = 0;
  std::string where;
  for (const Json* of : lanes) {
    for (const Json& question : of->at("total").at("questions")) {
      asked += number_at(question, "asked");
      beyond_range += question.at("band").value("unknown", std::uint64_t{0});
      if (const double band = question.at("largest_in_bounds"); band > widest) {
        widest = band;
        where = fmt::format("{} of {}", text_at(question, "question"), text_at(*of, "second"));
      }
    }
  }
  if (widest == 0) return "No sign differs.";
  return fmt::format(
      "Signs differ only where both values are at most {} bounds of their rounding error away from zero ({}). "
      "Among {} comparisons on {}, no sign differs farther from zero{}. At 95 % confidence, such a difference{} "
      "occurs on fewer than {} of the pairs.",
      rounded_up(widest, 2), where, grouped(asked), counted(pairs, "pair"),
      beyond_range == 0 ? ""
                        : fmt::format(", except in {} comparisons whose error has no bound", grouped(beyond_range)),
      beyond_range == 0 ? "" : ", where the error has a bound,", rounded_up(analysis::upper_bound(0, pairs), 2));
}

std::string mending_sentence(const Json& json) {
  const std::uint64_t pairs = number_at(json, "pairs");
  std::uint64_t values = 0, lanes = 0, others = 0, most = 0;
  for (const Json& of : json.at("lanes")) {
    const std::string first = text_at(of, "first"), second = text_at(of, "second");
    if (!(first.ends_with("/cpu") && second.ends_with("/cuda-nofma")) &&
        !(second.ends_with("/cpu") && first.ends_with("/cuda-nofma")))
      continue;
    ++lanes;
    values += sum_at(of.at("total"), "compared");
    others += number_at(of.at("total"), "differs") > 0;
    most = std::max(most, number_at(of.at("total"), "differs"));
  }
  if (lanes == 0)
    return "No remedy was measured here: compare cpu with cuda-nofma (-fmad=false), and see `graze tune "
           "--agree`.";
  if (others > 0)
    return fmt::format("-fmad=false does not mend it: in {} of {}, values still differ, on up to {} of {}.", others,
                       counted(lanes, "comparison"), grouped(most), counted(pairs, "pair"));
  return fmt::format(
      "-fmad=false mends it: cpu and cuda-nofma have the same bits in all {} values on {} of triangles ({}). `graze "
      "bench` and docs/measurements.md have its cost and the cost of the exact lane.",
      grouped(values), counted(pairs, "pair"), counted(lanes, "comparison"));
}

}  // namespace

std::vector<std::string> discrepancy_answer(const Json& json) {
  std::vector<std::string> verdicts;
  for (const Json& of : json.value("verdicts", Json::array())) verdicts.push_back(verdicts_sentence(of));
  if (json.at("lanes").empty()) return verdicts;
  const std::vector<const Json*> lanes = differing_lanes(json);
  std::vector<std::string> answer = {
      shares_sentence(lanes, json.at("lanes").size() - lanes.size()) + unlike_words(json), start_sentence(lanes),
      nearer_sentence(lanes), band_sentence(lanes, number_at(json, "pairs")), mending_sentence(json)};
  answer.insert(answer.end(), verdicts.begin(), verdicts.end());
  return answer;
}

}  // namespace graze::reports
