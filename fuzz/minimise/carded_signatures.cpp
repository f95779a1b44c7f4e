// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/carded_signatures.h"

#include <algorithm>
#include <map>
#include <set>

#include "analysis/signature.h"
#include "core/lanes.h"

namespace graze::fuzz {
namespace {

// Whether two lanes of one scalar have different marks.
bool shows_contraction(const Json& lane_ids, const std::string& key) {
  const auto signature = analysis::parse_signature(key);
  std::map<std::string, std::set<char>> marks;  // by scalar
  for (const Json& id : lane_ids) {
    const auto lane = parse_lane_name(id.get<std::string>());
    if (signature && lane && lane->subject == signature->subject)
      marks[lane->scalar].insert(signature->mark_of(lane->within_subject()));
  }
  return std::any_of(marks.begin(), marks.end(), [](const auto& of_scalar) { return of_scalar.second.size() > 1; });
}

}  // namespace

std::vector<std::size_t> carded_signatures(const Json& summary) {
  struct Row {
    std::size_t place;
    std::string key;
  };
  std::map<std::string, std::vector<Row>> of_algorithm;  // the commonest first, as the summary has them
  const Json& rows = summary.at("signatures");
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const std::string key = rows.at(place).at("key");
    of_algorithm[analysis::subject_of(key)].push_back({place, key});
  }
  std::vector<std::size_t> cards;
  for (const auto& [algorithm, own] : of_algorithm) {
    const std::size_t share = std::max<std::size_t>(1, kMostCards / of_algorithm.size());
    const std::size_t commonest = share - share / 4;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < own.size() && taken < share; ++i) {
      if (i >= commonest && !shows_contraction(summary.at("spec").at("lanes"), own[i].key)) continue;
      cards.push_back(own[i].place);
      ++taken;
    }
  }
  std::sort(cards.begin(), cards.end());
  return cards;
}

}  // namespace graze::fuzz
