// SPDX-License-Identifier: Apache-2.0
// For tests: foreign code that runs a function of the test itself.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <utility>

#include "core/lanes/lanes.h"

namespace graze::analysis {

// Runs a function of this process as foreign code.
class Stranger : public ForeignCode {
 public:
  using Function = std::function<Verdict(const Pair&)>;
  using OnDoubles = std::function<Verdict(const DoublePair&)>;
  explicit Stranger(Function function, OnDoubles on_doubles = nullptr)
      : function_(std::move(function)), on_doubles_(std::move(on_doubles)) {}

  void decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) override {
    decide_by(function_, pairs, count, intersects, declined);
  }
  Verdict failure(const Pair& pair) override { return function_(pair); }
  bool decides_doubles() const override { return bool(on_doubles_); }
  void decide_doubles(const DoublePair* pairs, std::size_t count, std::uint64_t* intersects,
                      std::uint64_t* declined) override {
    decide_by(on_doubles_, pairs, count, intersects, declined);
  }
  Verdict failure_on_doubles(const DoublePair& pair) override { return on_doubles_(pair); }

  std::atomic<std::size_t> asked = 0;  // pairs

 private:
  template <class Real>
  void decide_by(const std::function<Verdict(const BasicPair<Real>&)>& function, const BasicPair<Real>* pairs,
                 std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
    std::fill_n(intersects, (count + 63) / 64, 0);
    std::fill_n(declined, (count + 63) / 64, 0);
    asked += count;
    for (std::size_t i = 0; i < count; ++i) {
      const Verdict verdict = function(pairs[i]);
      const bool failed = is_failure(verdict);
      intersects[i / 64] |= std::uint64_t{failed || verdict == Verdict::intersects} << i % 64;
      declined[i / 64] |= std::uint64_t{failed || verdict == Verdict::declined} << i % 64;
    }
  }

  Function function_;
  OnDoubles on_doubles_;
};

}  // namespace graze::analysis
