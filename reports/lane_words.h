// SPDX-License-Identifier: Apache-2.0
// Wording for lanes and their rates, shared by the sentences of a report's answer.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "core/lanes/lanes.h"
#include "core/wilson.h"
#include "reports/counts.h"
#include "reports/findings.h"
#include "reports/terminal.h"

namespace graze::reports {

using LaneIndices = std::vector<std::size_t>;

// Indices of the lanes that are not exact.
inline LaneIndices published(const CampaignCounts& counts) {
  LaneIndices places;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    if (!counts.lanes[l].exact) places.push_back(l);
  }
  return places;
}

// Whether the subject is a published algorithm rather than a user's own code.
inline bool is_published(const std::string& subject) {
  return std::any_of(graze::published_lanes().begin(), graze::published_lanes().end(),
                     [&](const Lane& lane) { return lane.info->id == subject; });
}
inline bool all_published(const CampaignCounts& counts) {
  const LaneIndices lanes = published(counts);
  return std::all_of(lanes.begin(), lanes.end(),
                     [&](std::size_t l) { return is_published(counts.lanes[l].name.subject); });
}

// Whether two lanes are variants of one algorithm in one precision.
inline bool same_family(const CampaignCounts& counts, std::size_t l, std::size_t r) {
  return counts.lanes[l].name.subject == counts.lanes[r].name.subject &&
         counts.lanes[l].name.scalar == counts.lanes[r].name.scalar;
}

// "12 pairs (1.2 %, 95 % interval 0.7 % to 2.1 %)"
inline std::string with_interval(const Share& s, const char* what = "") {
  return fmt::format("{}{} ({}, 95 % interval {} to {})", grouped(s.count), what, rate_words(s.share),
                     rate_words(s.low, Bound::lower), rate_words(s.high, Bound::upper));
}

// "a, b and c"; if there are more than four, the first three and the number of others.
inline std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  const std::size_t named = names.size() <= kMost + 1 ? names.size() : kMost;
  std::string text;
  for (std::size_t i = 0; i < named; ++i) {
    const bool last = i + 1 == named && named == names.size();
    text += (i == 0 ? "" : last ? " and " : ", ") + names[i];
  }
  return named < names.size() ? fmt::format("{} and {} more", text, names.size() - named) : text;
}

inline std::string ids(const CampaignCounts& counts, const LaneIndices& places) {
  std::vector<std::string> names;
  for (const std::size_t l : places) names.push_back(counts.lanes[l].id);
  return list_of(names);
}

}  // namespace graze::reports
