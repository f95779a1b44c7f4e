// SPDX-License-Identifier: Apache-2.0
// The parts of a report that describe single failures: a card for each kind, and a row for each signature.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "reports/counts.h"

namespace graze::reports {

// Limits on the size of the page: the rows of its table of signatures, and the bytes of all its ulp maps.
inline constexpr std::size_t kMostSignatures = 5'000;
inline constexpr std::size_t kMostMapBytes = 7 << 18;

// Placeholder in a card's program for the source of its algorithm, which the report stores once, in `sources`.
inline constexpr std::string_view kSourceMark = "@SOURCE@";

// Returns one row for each signature, the most frequent first.
nlohmann::ordered_json signature_rows(const CampaignCounts& counts, const nlohmann::ordered_json& summary);

// Adds the signatures' rows, the most frequent first, and a card for each kind of failure (fuzz/minimise/kinds.h).
// Reads the case files and the minimiser's results beside them. Lists missing parts in `missing`.
// Throws: FormatError.
void add_signatures(nlohmann::ordered_json& report, const std::filesystem::path& directory,
                    const nlohmann::ordered_json& summary, const CampaignCounts& counts);

}  // namespace graze::reports
