// SPDX-License-Identifier: Apache-2.0
// Verdicts of foreign code, and of changed builds of its source, on images of one pair, for experiments.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/changed_source.h"
#include "analysis/experiments.h"
#include "analysis/scales.h"
#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "subjects/rebuilt.h"

namespace graze::analysis {

// Two neighbouring scales: the lane is wrong at one and right at the other.
struct Turn {
  int wrong, right;
  bool upwards() const { return right > wrong; }
  std::string text() const { return fmt::format("scaled by 2^{} it is right, by 2^{} wrong", right, wrong); }
};

// The result of trying scales in range. right: whether the lane is right at the first scale and, if there is no turn,
// at all scales.
struct ScaleSearch {
  std::optional<Turn> turn;
  bool right;
  Scales tried;  // from the least to the greatest scale tried
};

// Whether the code is wrong at all larger scales that were tried, up to 2^most.
struct LargerScales {
  bool wrong;
  int most;
  std::string text() const { return fmt::format("all larger scales that were tried, up to 2^{}", most); }
};

// The lane of the same code in float64, if it runs on this host; else null.
inline const Lane* in_float64(const Lane& lane) {
  if (lane.scalar == Scalar::f64) return nullptr;
  LaneName other = lane.lane_name();
  other.scalar = name(Scalar::f64);
  const Lane* found = find_lane(id_of(other));
  return found && backends::on_host(*found) ? found : nullptr;
}

template <class Real>
class ImageVerdicts {
  using PairOf = BasicPair<Real>;

 public:
  ImageVerdicts(const Lane& lane, const PairOf& pair, Verdict truth) : lane_(lane), pair_(pair), truth_(truth) {}

  std::vector<Verdict> said(const DecideBlock& block, std::span<const PairOf> pairs) const {
    asked_ += static_cast<int>(pairs.size());
    std::vector<Verdict> verdicts = verdicts_of(block, pairs);
    late_ += static_cast<int>(std::count(verdicts.begin(), verdicts.end(), Verdict::timed_out));
    declined_ += static_cast<int>(std::count(verdicts.begin(), verdicts.end(), Verdict::declined));
    return verdicts;
  }

  // For each pair, whether the block is right. False for pairs that were not tried because too many others timed out.
  // until_wrong: try no more pairs after the call that finds the first wrong verdict.
  std::vector<bool> asked(const DecideBlock& block, const std::vector<PairOf>& pairs, bool until_wrong = false) const {
    std::vector<bool> right(pairs.size());
    for (std::size_t begin = 0, size; begin < pairs.size() && late_ < kMostLate; begin += size) {
      const bool prompt = late_ == 0 && asked_ >= static_cast<int>(foreign_at_once(false));
      size = std::min(foreign_at_once(prompt && !until_wrong), pairs.size() - begin);
      const std::vector<Verdict> verdicts = said(block, std::span(pairs).subspan(begin, size));
      std::transform(verdicts.begin(), verdicts.end(), right.begin() + static_cast<std::ptrdiff_t>(begin),
                     [this](Verdict verdict) { return verdict == truth_; });
      if (until_wrong && std::any_of(verdicts.begin(), verdicts.end(), [this](Verdict v) { return v != truth_; }))
        break;
    }
    return right;
  }
  std::vector<bool> asked(const Lane& lane, const std::vector<PairOf>& pairs) const {
    return asked(block_of(lane), pairs);
  }

  // Tries at most `most` evenly spaced scales. Returns each scale and whether the lane is right there.
  std::vector<std::pair<int, bool>> tried(const Lane& lane, Scales scales, int most) const {
    return tried(block_of(lane), scales, most);
  }
  std::vector<std::pair<int, bool>> tried(const DecideBlock& block, Scales scales, int most) const {
    std::vector<std::pair<int, bool>> result;
    if (scales.empty()) return result;
    const int step = std::max(1, (scales.last - scales.first) / most + 1);
    std::vector<PairOf> pairs;
    for (int k = scales.first; k <= scales.last; k += step) {
      result.emplace_back(k, false);
      pairs.push_back(scaled(pair_, k));
    }
    const std::vector<bool> right = asked(block, pairs);
    for (std::size_t i = 0; i < right.size(); ++i) result[i].second = right[i];
    return result;
  }

  // Finds a turn between these two scales.   Requires: the lane is wrong at the first scale and right at the second.
  Turn bisected(int wrong, int right) const {
    while (std::abs(right - wrong) > 1) {
      const int middle = wrong + (right - wrong) / 2;
      (asked(lane_, {scaled(pair_, middle)})[0] ? right : wrong) = middle;
    }
    return last_turn_ = {wrong, right};
  }

  // Whether the same code in float64 is right at all tried scales at which no product leaves its exponent range.
  bool right_in_float64_at_every_scale() const {
    const DecideBlock f64 = in_float64();
    if (!f64) return false;
    const Scales scales = scales_in_range(Size(pair_), Scalar::f64, kMostFactors);
    const auto all = tried(f64, scales, 24);
    return scales.has(0) && std::all_of(all.begin(), all.end(), [](const auto& one) { return one.second; });
  }

  // Finds two neighbouring scales in range such that the lane is right at only one of them. Prefers a turn whose larger
  // scale is right.
  ScaleSearch turn_within(Scales in_range, int most) const {
    auto inside = tried(lane_, in_range, most);
    const std::pair own{0, false};
    if (in_range.has(0)) inside.insert(std::lower_bound(inside.begin(), inside.end(), own), own);
    ScaleSearch search{std::nullopt, inside[0].second, {inside.front().first, inside.back().first}};
    for (const bool upwards : {true, false}) {
      for (std::size_t i = inside.size() - 1; i > 0; --i) {
        const auto [k, right] = inside[i];
        if (right != upwards || inside[i - 1].second == upwards) continue;
        search.turn = upwards ? bisected(inside[i - 1].first, k) : bisected(k, inside[i - 1].first);
        return search;
      }
    }
    return search;
  }

  // Tries some scales from 1 to `last`, and returns whether the block is wrong at all of them.   Requires: last > 0
  LargerScales until(const DecideBlock& block, int last) const {
    const auto larger = tried(block, {1, last}, 12);
    return {std::none_of(larger.begin(), larger.end(), [](const auto& one) { return one.second; }),
            larger.back().first};
  }

  // The lane's code in doubles: its own function of doubles, or else its source with double in place of float. Null if
  // there is none.
  DecideBlock in_float64() const {
    if (const Lane* f64 = analysis::in_float64(lane_)) return block_of(*f64);
    if (lane_.scalar == Scalar::f64) return nullptr;
    if (!doubles_) doubles_ = subjects::changed(lane_, {.doubles = true});
    return *doubles_ ? DecideBlock(**doubles_) : nullptr;
  }

  std::string in_float64_words() const {
    return analysis::in_float64(lane_) ? "in float64 " : "with double in place of float ";
  }

  bool right_in_float64() const {
    const DecideBlock f64 = in_float64();
    return f64 && asked(f64, {pair_})[0];
  }

  int verdicts() const { return asked_; }
  bool gave_up() const { return late_ >= kMostLate; }
  bool declined_some() const { return declined_ > 0; }
  Turn last_turn() const { return last_turn_; }

 private:
  static constexpr int kMostLate = 3;  // after this many time-outs no more verdicts are requested

  const Lane& lane_;
  const PairOf& pair_;
  const Verdict truth_;
  mutable int asked_ = 0, late_ = 0, declined_ = 0;  // numbers of verdicts asked for, that timed out, that declined
  mutable std::optional<subjects::ChangedCode> doubles_;
  mutable Turn last_turn_{0, 0};
};

}  // namespace graze::analysis
