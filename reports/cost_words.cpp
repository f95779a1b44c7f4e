// SPDX-License-Identifier: Apache-2.0
#include "reports/cost_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "reports/terminal.h"

namespace graze::reports {
namespace {

constexpr double kNoisy = 0.25;  // share of the median

std::string nanoseconds(double value) {
  if (value >= 1000) return grouped(static_cast<std::uint64_t>(std::llround(value)));
  return fmt::format("{:.{}f}", value, value < 1 ? 4 : value < 10 ? 1 : 0);
}

constexpr const char* kAgain = "measure again on an idle machine";

}  // namespace

bool is_noisy(const analysis::Cost& cost) { return cost.high - cost.low > kNoisy * cost.middle; }

bool is_cheaper(const analysis::Cost& cost, const analysis::Cost& other) { return cost.high < other.low; }

std::string cost_words(const analysis::Cost& cost) {
  return fmt::format("{} ns ({} to {}{})", nanoseconds(cost.middle), nanoseconds(cost.low), nanoseconds(cost.high),
                     is_noisy(cost) ? "; noisy" : "");
}

std::string costs_sentence(analysis::Calls calls, const std::string& pairs, const std::string& machine, int passes) {
  return fmt::format(
      "Costs are times per pair on one core of {}: the median of {} passes, with their quartiles, over {}, {}. "
      "A cost is marked noisy if its quartiles are further apart than a quarter of the median: {}.",
      machine, passes, pairs,
      calls == analysis::Calls::of_one ? "one pair a call"
                                       : "many pairs a call; graze pareto times calls of one pair too",
      kAgain);
}

std::string one_call_sentence(std::span<const std::string> lanes, std::span<const analysis::Cost> costs,
                              const std::string& pairs, const std::string& machine, int passes) {
  std::vector<std::string> parts;
  for (std::size_t l = 0; l < lanes.size(); ++l)
    parts.push_back(fmt::format("{} in {}", cost_words(costs[l]), lanes[l]));
  return fmt::format("A call of one pair takes {}: median and quartiles of {} passes over {}, on one core of {}.",
                     fmt::join(parts, ", "), passes, pairs, machine);
}

std::string noisy_sentence(std::span<const std::string> lanes, std::span<const analysis::Cost> costs) {
  std::vector<std::string> noisy;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (is_noisy(costs[l])) noisy.push_back(fmt::format("{} {}", lanes[l], cost_words(costs[l])));
  }
  return noisy.empty() ? "" : fmt::format("Noisy measurements: {}; {}.", fmt::join(noisy, ", "), kAgain);
}

}  // namespace graze::reports
