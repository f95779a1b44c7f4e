// SPDX-License-Identifier: Apache-2.0
// The map of toolchains shows how the verdicts of one source differ between the compilers and processors of a campaign.
#pragma once

#include <nlohmann/json.hpp>

#include "reports/counts.h"

namespace graze::reports {

// Returns a row for each algorithm and scalar. A row has a cell for each variant without a policy: the share of
// verdicts that differ from the reference's, and the share that are wrong. Variants that agree on every pair of every
// row form a group. The reference is x86-gcc, else cpu, else the first variant. ToolchainMap in
// reports/web/src/report.ts describes the JSON.
//
// Two lanes of a subject differ on a pair exactly if the pair's signature marks them differently, so the signatures'
// counts suffice. A lane has no count if it declines pairs or its convention covers some, because not all
// of these pairs have a signature. signatures: as signature_rows returns them (failure_cards.h).   Returns: null if
// no toolchain ran.
nlohmann::ordered_json toolchain_map(const CampaignCounts& counts, const nlohmann::ordered_json& signatures);

// Whether a program built by a toolchain ran as a lane of the campaign.
bool has_toolchains(const CampaignCounts& counts);

}  // namespace graze::reports
