// SPDX-License-Identifier: Apache-2.0
// Prints results on a terminal: a campaign's summary, and one pair's verdicts. It never computes a verdict.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <span>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "oracle/truth.h"
#include "reports/screen.h"

namespace graze::reports {

// Prints the contents of summary.json as two tables: errors by stratum and algorithm, and errors by lane. Also prints
// which exact decisions support these counts.   oracle: as in fuzz::Outcome.
void print_summary(std::ostream& out, const nlohmann::ordered_json& summary, const nlohmann::ordered_json& oracle,
                   const Screen& screen = {});

// Prints one pair: its coordinates as decimals and hex floats, the truth, and a verdict for each lane. Wrong verdicts
// are marked.   Requires: verdicts[i] belongs to lanes[i].
void print_pair(std::ostream& out, const AnyPair& pair, const oracle::Truth& truth, std::span<const Lane* const> lanes,
                std::span<const Verdict> verdicts, const Screen& screen = {});

// A percentage without the % sign, formatted as on the report's page: "47.8", "9.56", "0.156", "<0.001", "0".
std::string bare_percent(std::uint64_t part, std::uint64_t whole);

// 1234567 as "1,234,567".
std::string grouped(std::uint64_t number);

// "1 pair", "2,000 pairs".   what: a singular whose plural ends in s.
std::string counted(std::uint64_t number, const char* what);

}  // namespace graze::reports
