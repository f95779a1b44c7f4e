// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "reports/counts.h"

namespace graze::reports {

// What keeps the page's size: rows in its table, and bytes of all its maps.
inline constexpr std::size_t kMostSignatures = 5'000;
inline constexpr std::size_t kMostMapBytes = 7 << 18;

// Stands in a card's program for the source of its algorithm, which the report holds once, in `sources`.
inline constexpr std::string_view kSourceMark = "@SOURCE@";

// The share as a row of a signature has it.
double rounded_share(std::uint64_t count, std::uint64_t of);

// One row for each signature, the commonest first.
nlohmann::ordered_json signature_rows(const CampaignCounts& counts, const nlohmann::ordered_json& summary);

// The signatures' rows, the commonest first, and a card for each kind of failure (fuzz/minimise/kinds.h), from the case
// files and what the minimiser stored beside them. What they lack is said in `missing`.   Throws: FormatError.
void add_signatures(nlohmann::ordered_json& report, const std::filesystem::path& directory,
                    const nlohmann::ordered_json& summary, const CampaignCounts& counts);

}  // namespace graze::reports
