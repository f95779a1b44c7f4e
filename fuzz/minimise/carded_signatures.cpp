// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/carded_signatures.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace graze::fuzz {
namespace {

// Whether two lanes of one scalar that ran have different marks.
bool shows_contraction(const std::string& key) {
  const std::string_view marks = std::string_view(key).substr(key.rfind(':') + 1);
  for (std::size_t first = 0; first < marks.size(); first += kTargetCount) {
    char seen = '_';
    for (const char mark : marks.substr(first, kTargetCount)) {
      if (mark != '_' && seen != '_' && mark != seen) return true;
      if (mark != '_') seen = mark;
    }
  }
  return false;
}

}  // namespace

std::vector<std::size_t> carded_signatures(const Json& summary) {
  struct Row {
    std::size_t place;
    std::string key;
  };
  std::map<std::string, std::vector<Row>> of_algorithm;  // the commonest first, as the summary has them
  const Json& rows = summary["signatures"];
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const std::string key = rows[place]["key"];
    // Pairs on which a device and its twin differ are nobody's failure.
    if (!key.starts_with("executors/")) of_algorithm[analysis::algorithm_of(key)].push_back({place, key});
  }
  std::vector<std::size_t> cards;
  for (const auto& [algorithm, own] : of_algorithm) {
    const std::size_t share = std::max<std::size_t>(1, kMostCards / of_algorithm.size());
    const std::size_t commonest = share - share / 4;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < own.size() && taken < share; ++i) {
      if (i >= commonest && !shows_contraction(own[i].key)) continue;
      cards.push_back(own[i].place);
      ++taken;
    }
  }
  std::sort(cards.begin(), cards.end());
  return cards;
}

}  // namespace graze::fuzz
