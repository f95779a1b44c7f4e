// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/counts.h"

namespace graze {

// The signatures' rows, the commonest first, and the cards of those that have one (fuzz/cards.h), from the case files
// and what the minimiser stored beside them. What they lack is said in `missing`.
// Throws: FormatError; std::runtime_error for a case file without a case.
void add_signatures(nlohmann::ordered_json& report, const std::filesystem::path& directory,
                    const nlohmann::ordered_json& summary, const CampaignCounts& counts);

}  // namespace graze
