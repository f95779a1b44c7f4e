// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "fuzz/campaign/campaign.h"
#include "strata/scene/sources.h"

namespace graze::cli {

// Prints the result of a campaign at the end of `fuzz` and `merge`, and writes its picture to `out`. Defined in
// fuzz.cpp.
void print_campaign(const std::string& out, const fuzz::Outcome& outcome, bool json,
                    const std::vector<strata::LeftOut>& left_out = {});

// The same for a shard.
void print_shard(const std::string& out, const fuzz::Json& spec, const fuzz::Json& summary, bool json);

// A line for each subject whose hash leaves something out, such as the libraries that it loads; empty for none.
std::string not_covered_text(const fuzz::Json& spec);

}  // namespace graze::cli
