// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/sums.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

namespace graze::fuzz {

using Json = nlohmann::ordered_json;

Sums::Sums(const std::vector<strata::PairSource>& sources, int lanes)
    : sources_(sources), lanes_(lanes), of_source_(sources.size(), StoredCounts(lanes)), covered_(sources.size()) {}

void Sums::cover(const PairRange& range, std::size_t from) {
  auto& covered = covered_[static_cast<std::size_t>(range.source)];
  std::uint64_t first = range.first, end = range.first + range.pairs;
  auto next = covered.lower_bound(first);
  if (next != covered.end() && next->first < end)
    throw Overlap{{range.source, next->first, std::min(end, next->second.end) - next->first}, next->second.from, from};
  if (next != covered.begin()) {
    const auto before = std::prev(next);
    if (before->second.end > first)
      throw Overlap{{range.source, first, std::min(end, before->second.end) - first}, before->second.from, from};
    if (before->second.end == first && before->second.from == from) {
      first = before->first;
      covered.erase(before);
    }
  }
  if (next != covered.end() && next->first == end && next->second.from == from) {
    end = next->second.end;
    covered.erase(next);
  }
  covered[first] = {end, from};
}

void Sums::add(const PairRange& range, const StoredCounts& counts, std::size_t from) {
  cover(range, from);
  of_source_[static_cast<std::size_t>(range.source)].add(counts);
}

std::vector<PairRange> Sums::gaps(const PairRange& within) const {
  std::vector<PairRange> found;
  std::uint64_t at = within.first;
  const std::uint64_t end = within.first + within.pairs;
  for (const auto& [first, part] : covered_[static_cast<std::size_t>(within.source)]) {
    if (first >= end) break;
    if (first > at) found.push_back({within.source, at, first - at});
    at = std::max(at, part.end);
  }
  if (at < end) found.push_back({within.source, at, end - at});
  return found;
}

std::vector<PairRange> Sums::gaps() const {
  std::vector<PairRange> all;
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    for (const PairRange& gap : gaps(PairRange{static_cast<int>(s), 0, sources_[s].pairs})) all.push_back(gap);
  }
  return all;
}

std::string Sums::bytes() const {
  Json all = Json::array();
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    Json covered = Json::array();
    for (const auto& [first, part] : covered_[s]) covered.push_back({first, part.end - first});
    const std::string counts = to_bytes(of_source_[s]);
    all.push_back({std::move(covered), Json::binary({counts.begin(), counts.end()})});
  }
  std::string bytes;
  Json::to_cbor(all, bytes);
  return bytes;
}

void Sums::add(const std::string& bytes) {
  const Json all = Json::from_cbor(bytes, true, false);
  if (!all.is_array() || all.size() != sources_.size()) throw Damaged("a rank's sums and the sources do not agree");
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    PairRange hull{static_cast<int>(s), 0, sources_[s].pairs};
    std::uint64_t pairs = 0;
    for (const Json& part : all[s].at(0)) {
      cover({hull.source, part.at(0), part.at(1)}, 0);
      pairs += part.at(1).get<std::uint64_t>();
    }
    const auto& counts = all[s].at(1).get_binary();
    of_source_[s].add(from_bytes({counts.begin(), counts.end()}, hull, pairs, sources_[s].axis, lanes_));
  }
}

}  // namespace graze::fuzz
