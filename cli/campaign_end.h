// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "fuzz/campaign/campaign.h"
#include "strata/scene/sources.h"

namespace graze::cli {

// What a campaign has to say at the end of `fuzz` and of `merge`; leaves its picture in `out`. Defined in fuzz.cpp.
void print_campaign(const std::string& out, const fuzz::Outcome& outcome, bool json,
                    const std::vector<strata::LeftOut>& left_out = {});

// The same of a shard.
void print_shard(const std::string& out, const fuzz::Json& summary, bool json);

}  // namespace graze::cli
