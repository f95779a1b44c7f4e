// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "fuzz/campaign/shard.h"

namespace graze::cli {

// --shard K/N.
void add_shard_option(CLI::App& command, fuzz::Shard& shard, const char* description);

}  // namespace graze::cli
