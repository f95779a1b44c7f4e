// SPDX-License-Identifier: Apache-2.0
// Finds verdicts that changed between two campaigns on the same pairs, using only their databases, not their code.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace graze::fuzz {

// A lane's changed verdicts on a stratum. Both campaigns have the lane and the stratum.
struct ChangedVerdicts {
  enum class Known { same, changed, unknown };  // from the digests if possible, otherwise from the counts

  std::string lane, stratum;
  std::uint64_t pairs = 0;
  Known known = Known::unknown;
  std::uint64_t least = 0, most = 0;  // bounds on the number of pairs whose verdict changed
};

// Requires: databases of complete campaigns on the same pairs.   Throws: the errors of counts_of_database.
std::vector<ChangedVerdicts> changed_verdicts(const std::filesystem::path& before, const std::filesystem::path& after);

}  // namespace graze::fuzz
