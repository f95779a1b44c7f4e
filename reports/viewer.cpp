// SPDX-License-Identifier: Apache-2.0
#include "reports/viewer.h"

#include <fmt/format.h>

#include <bit>
#include <set>
#include <sstream>

#include "backends/backends.h"
#include "core/lanes/lanes.h"
#include "corpus/pair_format.h"
#include "cuda/twin/twin.h"
#include "oracle/truth.h"
#include "reports/page.h"
#include "strata/strata.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kText[] =
#include "viewer_template.inc"
    ;
constexpr std::string_view kTemplate(kText, sizeof kText - 1);
constexpr char kCanaries[] =
#include "canaries.inc"
    ;

constexpr std::uint64_t kReplaySeed = 20120131;
constexpr std::uint64_t kReplayed = 16;  // pairs of each stratum

std::string bits_of(const float* numbers, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += fmt::format("{:08x}", std::bit_cast<std::uint32_t>(numbers[i]));
  return text;
}

// The lanes that WebAssembly also has, if they run here.
std::vector<const Lane*> replayed_lanes() {
  std::vector<const Lane*> result;
  for (const Lane& lane : lanes()) {
    const bool rebuilt =
        lane.exact || backends::backend_of(lane).is_replayed || info_of(lane.variant).arithmetic == Arithmetic::rounded;
    if (lane.exact && lane.scalar == Scalar::f64)
      continue;  // on float32, which is all that it has, it is exact/f32/cpu
    if (rebuilt && !lane.foreign && !lane.under && backends::on_host(lane)) result.push_back(&lane);
  }
  return result;
}

std::vector<Pair> replayed_pairs() {
  std::vector<Pair> pairs;
  std::istringstream text(kCanaries);
  corpus::PairReader canaries(text, "canaries");
  while (const auto entry = canaries.next()) pairs.push_back(entry->pair);
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::uint64_t index = 0; index < kReplayed; ++index)
      pairs.push_back(strata::generate(kReplaySeed, row.stratum, index));
  }
  return pairs;
}

Json replay() {
  const std::vector<const Lane*> of = replayed_lanes();
  Json lanes = Json::array(), pairs = Json::array();
  for (const Lane* lane : of) lanes.push_back(lane->id);
  for (const Pair& pair : replayed_pairs()) {
    const oracle::Truth truth = oracle::truth(pair);
    std::string verdicts;
    for (const Lane* lane : of)
      verdicts += static_cast<char>('0' + static_cast<int>(decide_one(backends::on_host(*lane), pair)));
    pairs.push_back({{"bits", bits_of(coordinates(pair), kCoordinates)},
                     {"truth", name(truth.verdict)},
                     {"contact", name(truth.contact)},
                     {"verdicts", verdicts}});
  }
  return {{"lanes", lanes}, {"pairs", pairs}};
}

// The distinct kinds of evidence for the twins.
std::string evidence() {
  std::set<std::string> kinds;
  for (const Lane* lane : replayed_lanes()) {
    if (const std::string by = backends::backend_of(*lane).evidence(*lane, false); !by.empty() && !lane->exact)
      kinds.insert(by);
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

}  // namespace

bool has_viewer() { return !kTemplate.empty(); }

Json viewer_checks() { return has_viewer() ? Json({{"evidence", evidence()}, {"replay", replay()}}) : Json(); }

std::string viewer_page(const Viewed& viewed) {
  Json pairs = Json::array(), triangles = Json::array();
  for (const ViewedPair& one : viewed.pairs) {
    pairs.push_back({{"name", one.name}, {"bits", bits_of(coordinates(one.pair), kCoordinates)}});
    for (const SaidOfPair& said : one.said)
      pairs.back()["said"].push_back(
          {{"lane", said.lane}, {"verdict", name(said.verdict)}, {"wrong", said.wrong}, {"stored", said.stored}});
  }
  for (const auto& triangle : viewed.triangles) triangles.push_back(bits_of(&triangle[0].x, 9));
  Json data = {{"format", 1},
               {"title", viewed.title},
               {"pairs", pairs},
               {"triangles", triangles},
               {"opens", viewed.random > 0             ? "random"
                         : viewed.opens_with_triangles ? "triangles"
                                                       : "pair"}};
  if (!viewed.ids.empty()) data["ids"] = viewed.ids;
  if (!viewed.lanes_left_out.is_null()) data["lanes_left_out"] = viewed.lanes_left_out;
  if (viewed.random > 0) data["random"] = viewed.random;
  data.update(viewer_checks());
  return with_data(kTemplate, "view", data);
}

}  // namespace graze::reports
