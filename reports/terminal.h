// SPDX-License-Identifier: Apache-2.0
// Results for a terminal: a campaign's summary, one pair's verdicts. Renders; never computes a verdict.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <span>

#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "oracle/truth.h"
#include "reports/screen.h"

namespace graze::reports {

// What summary.json holds, as two tables: errors by stratum and algorithm, and by lane;
// and which exact decisions stand behind them (see Outcome).
void print_summary(std::ostream& out, const nlohmann::ordered_json& summary, const nlohmann::ordered_json& oracle,
                   const Screen& screen = {});

// One pair: its coordinates in decimals and hex floats, the truth, and a verdict for each lane, wrong ones marked.
// Requires: verdicts[i] is what lanes[i] says.
void print_pair(std::ostream& out, const Pair& pair, const oracle::Truth& truth, std::span<const Lane* const> lanes,
                std::span<const Verdict> verdicts, const Screen& screen = {});

// A share in per cent, without the sign, as the report's page has it: "47.8", "9.56", "0.156", "<0.001", "0".
std::string bare_percent(std::uint64_t part, std::uint64_t whole);

// 1234567 as "1,234,567".
std::string grouped(std::uint64_t number);

}  // namespace graze::reports
