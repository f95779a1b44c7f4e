// SPDX-License-Identifier: Apache-2.0
// How long the rest of a run takes, by what each kind of its work has cost so far: a pair of one stratum costs ten
// times a pair of another. A pure function of what it is told; it reads no clock.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace graze::fuzz {

class CostEstimate {
 public:
  // left: how many units of each kind of work the run has to do.
  explicit CostEstimate(const std::vector<std::uint64_t>& left) {
    for (const std::uint64_t units : left) kinds_.push_back({units});
  }

  // So many units of a kind are done, and took this long. Work that was found done is not measured: see skip.
  void add(std::size_t kind, std::uint64_t units, double seconds);
  void skip(std::size_t kind, std::uint64_t units) { kinds_[kind].left -= units; }

  // A unit of a kind that is not measured yet counts as much as the mean of those that are.
  // Returns: seconds of work, by one worker as `add` was told; nothing before anything is measured.
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
