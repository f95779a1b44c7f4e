// SPDX-License-Identifier: Apache-2.0
// What a user names a case by: a file of pairs, or a stratum's pair as STRATUM:SEED:INDEX.
#pragma once

#include <string>
#include <vector>

#include "corpus/pair_format.h"

namespace graze::cli {

// Returns: the cases, at least one; a stratum's pair has its three numbers as fields.
// Throws: UsageError for a name that is none, FormatError for a file that is not in the format or missing,
// std::runtime_error for one without a case.
std::vector<corpus::Entry> read_cases(const std::string& name);

}  // namespace graze::cli
