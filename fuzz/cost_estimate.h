// SPDX-License-Identifier: Apache-2.0
// Estimates how long the rest of a run takes, from the cost of each kind of work so far. A pair of one stratum can cost
// ten times as much as a pair of another. The estimate depends only on its inputs; it reads no clock.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace graze::fuzz {

class CostEstimate {
 public:
  // left: how many units of each kind of work remain.
  explicit CostEstimate(const std::vector<std::uint64_t>& left) {
    for (const std::uint64_t units : left) kinds_.push_back({units});
  }

  // Records that `units` of a kind are done and how long they took. For work that was done earlier, use skip.
  void add(std::size_t kind, std::uint64_t units, double seconds);
  void skip(std::size_t kind, std::uint64_t units) { kinds_[kind].left -= units; }

  // An unmeasured kind is assumed to have the mean unit cost of the measured kinds.
  // Returns: the remaining seconds for one worker like the measured one; nothing before the first measurement.
  std::optional<double> seconds_left() const;

  bool measured(std::size_t kind) const { return kinds_[kind].done > 0; }

 private:
  struct Kind {
    std::uint64_t left = 0, done = 0;
    double seconds = 0;
  };
  std::vector<Kind> kinds_;
};

}  // namespace graze::fuzz
