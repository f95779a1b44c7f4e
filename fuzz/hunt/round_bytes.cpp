// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/round_bytes.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/fnv1a.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

using Json = nlohmann::ordered_json;

Json binary(const std::string& bytes) { return Json::binary({bytes.begin(), bytes.end()}); }

Json to_json(const AnyPair& pair) {
  return visit(pair, [](const auto& own) { return binary({reinterpret_cast<const char*>(&own), sizeof own}); });
}

AnyPair pair_of(const Json& json) {
  const auto& bytes = json.get_binary();
  const std::optional<AnyPair> pair = pair_from(bytes.data(), bytes.size());
  if (!pair) throw Damaged("a pair's length");
  return *pair;
}

Mutation mutation_of(const Json& json) {
  const auto number = json.get<unsigned>();
  if (number >= static_cast<unsigned>(kMutationCount)) throw Damaged("a mutation's number");
  return static_cast<Mutation>(number);
}

Json to_json(const std::vector<Unit>& units) {
  Json rows = Json::array();
  for (const Unit& unit : units) rows.push_back({to_json(unit.pair), unit.features});
  return rows;
}

std::vector<Unit> units_of(const Json& rows) {
  std::vector<Unit> units;
  for (const Json& row : rows) units.push_back({pair_of(row.at(0)), row.at(1).get<Features>()});
  return units;
}

Json to_json(const std::map<std::uint64_t, FoundPair>& kept) {
  Json rows = Json::array();
  for (const auto& [index, found] : kept)
    rows.push_back({index, to_json(found.pair), static_cast<unsigned>(found.mutation)});
  return rows;
}

std::map<std::uint64_t, FoundPair> kept_of(const Json& rows) {
  std::map<std::uint64_t, FoundPair> kept;
  for (const Json& row : rows)
    kept.emplace(row.at(0).get<std::uint64_t>(), FoundPair{pair_of(row.at(1)), mutation_of(row.at(2))});
  return kept;
}

Json to_json(const std::array<MutationCounts, kMutationCount>& mutations) {
  Json rows = Json::array();
  for (const MutationCounts& counts : mutations) rows.push_back({counts.pairs, counts.disagreements, counts.units});
  return rows;
}

std::array<MutationCounts, kMutationCount> mutations_of(const Json& rows) {
  std::array<MutationCounts, kMutationCount> mutations{};
  for (std::size_t m = 0; m < mutations.size(); ++m) {
    const auto counts = rows.at(m).get<std::array<std::uint64_t, 3>>();
    mutations[m] = {counts[0], counts[1], counts[2]};
  }
  return mutations;
}

std::string cbor(const Json& json) {
  const std::vector<std::uint8_t> bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

std::string hash_of(const std::string& bytes, std::uint64_t campaign) {
  const std::uint64_t hash = fnv1a(bytes, campaign);
  return {reinterpret_cast<const char*>(&hash), sizeof hash};
}

template <class Real>
AnyPair copied(const void* bytes) {
  BasicPair<Real> pair;
  std::memcpy(&pair, bytes, sizeof pair);
  return pair;
}

}  // namespace

std::optional<AnyPair> pair_from(const void* bytes, std::size_t size) {
  if (size == sizeof(Pair)) return copied<float>(bytes);
  if (size == sizeof(DoublePair)) return copied<double>(bytes);
  return std::nullopt;
}

bool are_of_result(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes, true, false);
  return json.is_object() && (json.contains("counts") || json.contains("error"));
}

std::string error_bytes(const std::string& what, bool apart) { return cbor({{"error", what}, {"apart", apart}}); }

std::string result_bytes(const RoundResult& result) {
  return cbor({{"counts", binary(to_bytes(result.counts))},
               {"units", to_json(result.units)},
               {"kept", to_json(result.kept)},
               {"mutations", to_json(result.mutations)}});
}

RoundResult parse_result(const std::string& bytes, const RoundTask& task) {
  const Json json = Json::from_cbor(bytes);
  if (json.contains("error")) {
    const std::string what = json.at("error");
    if (json.at("apart")) throw oracle::OracleMismatch(what);
    throw std::runtime_error(what);
  }
  const int lanes = static_cast<int>(task.campaign->under_test->lanes.size());
  const auto& counts = json.at("counts").get_binary();
  RoundResult result(lanes);
  result.counts = from_bytes({counts.begin(), counts.end()}, task.range, Axis::none, lanes);
  result.units = units_of(json.at("units"));
  result.kept = kept_of(json.at("kept"));
  result.mutations = mutations_of(json.at("mutations"));
  return result;
}

std::string round_bytes(const KeptRound& round, std::uint64_t campaign) {
  Json kinds = Json::array();
  for (const NewKind& kind : round.kinds) kinds.push_back({kind.key, kind.index, static_cast<unsigned>(kind.mutation)});
  const std::string bytes = cbor({{"first", round.first},
                                  {"pairs", round.pairs},
                                  {"units", to_json(round.units)},
                                  {"kept", to_json(round.kept)},
                                  {"mutations", to_json(round.mutations)},
                                  {"coarse", round.coarse},
                                  {"kinds", kinds}});
  return hash_of(bytes, campaign) + bytes;
}

std::optional<KeptRound> parse_round(const std::string& text, std::uint64_t campaign) {
  constexpr std::size_t kHash = sizeof(std::uint64_t);
  if (text.size() < kHash) return std::nullopt;
  const std::string bytes = text.substr(kHash);
  if (text.substr(0, kHash) != hash_of(bytes, campaign)) return std::nullopt;
  const Json json = Json::from_cbor(bytes);
  KeptRound round;
  round.first = json.at("first");
  round.pairs = json.at("pairs");
  round.units = units_of(json.at("units"));
  round.kept = kept_of(json.at("kept"));
  round.mutations = mutations_of(json.at("mutations"));
  round.coarse = json.at("coarse");
  for (const Json& row : json.at("kinds")) round.kinds.push_back({row.at(0), row.at(1), mutation_of(row.at(2))});
  return round;
}

}  // namespace graze::fuzz
