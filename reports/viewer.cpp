// SPDX-License-Identifier: Apache-2.0
#include "reports/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>
#include <span>
#include <sstream>

#include "analysis/lane_trace.h"
#include "backends/backends.h"
#include "core/lanes/lanes.h"
#include "corpus/pair_format.h"
#include "cuda/twin/twin.h"
#include "oracle/truth.h"
#include "reports/page.h"
#include "reports/snippet.h"
#include "strata/pair_source.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kText[] =
#include "viewer_template.inc"
    ;
constexpr std::string_view kTemplate(kText, sizeof kText - 1);
#include "viewer_modules.inc"
constexpr std::string_view kModules[] = {{kModuleF32, sizeof kModuleF32 - 1}, {kModuleF64, sizeof kModuleF64 - 1}};

constexpr std::uint64_t kReplaySeed = 20120131;
constexpr std::uint64_t kReplayed = 16;  // pairs of each stratum

// The bits of the numbers. If the type is float32, every number must be a float32.
std::string bits_of(std::span<const double> numbers, Scalar type) {
  std::string text;
  for (const double x : numbers)
    text += type == Scalar::f64 ? fmt::format("{:016x}", std::bit_cast<std::uint64_t>(x))
                                : fmt::format("{:08x}", std::bit_cast<std::uint32_t>(static_cast<float>(x)));
  return text;
}
std::string bits_of(const AnyPair& pair, Scalar type) {
  return bits_of(std::span(coordinates(pair.doubles), kCoordinates), type);
}

// The lanes that run here and are also in the module of this coordinate type.
std::vector<const Lane*> replayed_lanes(Scalar type) {
  std::vector<const Lane*> result;
  for (const Lane& lane : lanes()) {
    const bool rebuilt =
        lane.exact || backends::backend_of(lane).is_replayed || info_of(lane.variant).arithmetic == Arithmetic::rounded;
    if (lane.exact && lane.scalar == Scalar::f64 && type == Scalar::f32) continue;  // there it equals exact/f32/cpu
    if (rebuilt && !lane.foreign && !lane.under && backends::on_host(lane)) result.push_back(&lane);
  }
  return result;
}

std::vector<AnyPair> replayed_pairs(Scalar type) {
  std::vector<AnyPair> pairs;
  std::istringstream text{std::string(embedded("cuda/twin/canaries.pairs"))};
  corpus::PairReader canaries(text, "canaries");
  while (const auto entry = canaries.next()) pairs.emplace_back(entry->pair);
  const PairTypes drawn = type == Scalar::f32 ? PairTypes::f32 : PairTypes::f64;
  for (const strata::PairSource& stratum : strata::stratum_sources(kReplaySeed, kReplayed, {}, drawn)) {
    for (std::uint64_t index = 0; index < kReplayed; ++index) pairs.push_back(stratum.any_pair(index));
  }
  if (type == Scalar::f32) return pairs;
  for (AnyPair& pair : pairs) pair.floats.reset();
  return pairs;
}

Json replay(Scalar type) {
  const std::vector<const Lane*> of = replayed_lanes(type);
  Json lanes = Json::array(), pairs = Json::array();
  for (const Lane* lane : of) lanes.push_back(lane->id);
  for (const AnyPair& pair : replayed_pairs(type)) {
    const oracle::Truth truth = oracle::truth(pair);
    std::string verdicts;
    for (const Lane* lane : of)
      verdicts += static_cast<char>('0' + static_cast<int>(analysis::decide_lane(*lane, pair)));
    pairs.push_back({{"bits", bits_of(pair, type)},
                     {"truth", name(truth.verdict)},
                     {"contact", name(truth.contact)},
                     {"verdicts", verdicts}});
  }
  return {{"lanes", lanes}, {"pairs", pairs}};
}

// The distinct kinds of evidence for twins.
std::string evidence(Scalar type) {
  std::set<std::string> kinds;
  for (const Lane* lane : replayed_lanes(type)) {
    if (const std::string by = backends::backend_of(*lane).evidence(*lane, type == Scalar::f64);
        !by.empty() && !lane->exact)
      kinds.insert(by);
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

}  // namespace

bool has_viewer() { return !kTemplate.empty(); }

Json viewer_parts(Scalar coordinates) {
  if (!has_viewer()) return nullptr;
  return {{"module", kModules[static_cast<int>(coordinates)]},
          {"evidence", evidence(coordinates)},
          {"replay", replay(coordinates)}};
}

std::string viewer_page(const Viewed& viewed) {
  const bool any_doubles =
      std::any_of(viewed.pairs.begin(), viewed.pairs.end(), [](const ViewedPair& one) { return !one.pair.floats; });
  const Scalar type = any_doubles ? Scalar::f64 : Scalar::f32;
  Json pairs = Json::array(), triangles = Json::array();
  for (const ViewedPair& one : viewed.pairs) {
    pairs.push_back({{"name", one.name}, {"bits", bits_of(one.pair, type)}});
    for (const SaidOfPair& said : one.said)
      pairs.back()["said"].push_back(
          {{"lane", said.lane}, {"verdict", name(said.verdict)}, {"wrong", said.wrong}, {"stored", said.stored}});
  }
  for (const auto& triangle : viewed.triangles) triangles.push_back(bits_of(std::span(&triangle[0].x, 9), type));
  Json data = {{"format", 2},
               {"coordinates", name(type)},
               {"title", viewed.title},
               {"pairs", pairs},
               {"triangles", triangles},
               {"opens", viewed.random > 0             ? "random"
                         : viewed.opens_with_triangles ? "triangles"
                                                       : "pair"}};
  if (!viewed.ids.empty()) data["ids"] = viewed.ids;
  if (!viewed.lanes_left_out.is_null()) data["lanes_left_out"] = viewed.lanes_left_out;
  if (viewed.random > 0) data["random"] = viewed.random;
  data.update(viewer_parts(type));
  return with_data(kTemplate, "view", data);
}

}  // namespace graze::reports
