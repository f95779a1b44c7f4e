// SPDX-License-Identifier: Apache-2.0
#include "strata/pair_source.h"

#include <algorithm>

#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/text.h"
#include "strata/strata.h"

namespace graze::strata {

std::vector<PairSource> stratum_sources(std::uint64_t seed, std::uint64_t pairs,
                                        const std::vector<std::string>& globs) {
  for (const std::string& glob : globs) {
    const std::string wanted = glob.substr(glob.starts_with('!'));
    if (std::none_of(std::begin(kStrata), std::end(kStrata),
                     [&](const StratumInfo& row) { return matches_any({wanted}, row.id); })) {
      std::vector<std::string> ids;
      for (const StratumInfo& row : kStrata) ids.emplace_back(row.id);
      throw UsageError("no stratum matches '" + printable(glob) + "'; `graze strata` lists them" +
                       did_you_mean(glob, ids));
    }
  }
  std::vector<PairSource> sources;
  for (const StratumInfo& row : kStrata) {
    if (!matches_any(globs, row.id)) continue;
    sources.push_back({std::string(row.id), 0,
                       [seed, stratum = row.stratum](std::uint64_t index) { return generate(seed, stratum, index); },
                       static_cast<int>(row.stratum), row.axis, seed});
  }
  if (sources.empty()) {
    std::string names;
    for (const std::string& glob : globs) names += (names.empty() ? "" : ",") + glob;
    throw UsageError("strata \"" + printable(names) + "\" leave none");
  }
  for (std::size_t s = 0; s < sources.size(); ++s)
    sources[s].pairs = pairs / sources.size() + (s < pairs % sources.size());
  return sources;
}

}  // namespace graze::strata
