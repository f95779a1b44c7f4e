// SPDX-License-Identifier: Apache-2.0
#include "fuzz/cost_estimate.h"

namespace graze::fuzz {

void CostEstimate::add(std::size_t kind, std::uint64_t units, double seconds) {
  kinds_[kind].left -= units;
  kinds_[kind].done += units;
  kinds_[kind].seconds += seconds;
}

std::optional<double> CostEstimate::seconds_left() const {
  double costs = 0, known = 0, sum = 0;
  for (const Kind& kind : kinds_) {
    if (kind.done == 0) continue;
    costs += kind.seconds / static_cast<double>(kind.done);
    ++known;
  }
  if (known == 0) return {};
  for (const Kind& kind : kinds_) {
    const double cost = kind.done > 0 ? kind.seconds / static_cast<double>(kind.done) : costs / known;
    sum += cost * static_cast<double>(kind.left);
  }
  return sum;
}

}  // namespace graze::fuzz
