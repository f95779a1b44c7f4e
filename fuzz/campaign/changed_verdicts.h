// SPDX-License-Identifier: Apache-2.0
// What the databases of two campaigns on the same pairs tell of verdicts that changed, without the code that ran.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace graze::fuzz {

// Of a lane on a stratum, both in both campaigns.
struct ChangedVerdicts {
  enum class Known { same, changed, unknown };  // same and changed by the digests, or changed by the counts alone

  std::string lane, stratum;
  std::uint64_t pairs = 0;
  Known known = Known::unknown;
  std::uint64_t least = 0, most = 0;  // bounds of the number of pairs whose verdict changed
};

// Requires: databases of complete campaigns on the same pairs.   Throws: as counts_of_database.
std::vector<ChangedVerdicts> changed_verdicts(const std::filesystem::path& before, const std::filesystem::path& after);

}  // namespace graze::fuzz
